#include "bsdf/list.h"

#include "bsdf/compile_model.h"
#include "core/error.h"

namespace nacre {

#define NACRE_DECLARE(Model, header) extern const CompiledModel compiled_##Model;
NACRE_MODELS(NACRE_DECLARE)
#undef NACRE_DECLARE

namespace {

#define NACRE_ADDRESS(Model, header) &compiled_##Model,
constexpr const CompiledModel* compiled[] = {NACRE_MODELS(NACRE_ADDRESS)};
#undef NACRE_ADDRESS

} // namespace

const std::vector<ModelInfo>& model_infos() {
  static const std::vector<ModelInfo> infos = [] {
    std::vector<ModelInfo> all;
    for (const CompiledModel* model : compiled)
      all.push_back(model->describe());
    return all;
  }();
  return infos;
}

int model_index(std::string_view name) {
  const auto& infos = model_infos();
  for (std::size_t i = 0; i < infos.size(); ++i)
    if (infos[i].name == name) return int(i);
  std::vector<std::string> names;
  for (const auto& info : infos)
    names.push_back(info.name);
  throw Error("unknown model '" + std::string(name) + "'" + suggestion(name, names));
}

const ModelInfo& find_model(std::string_view name) { return model_infos()[std::size_t(model_index(name))]; }

bool ModelInfo::has(std::string_view parameter) const {
  return std::any_of(parameters.begin(), parameters.end(),
                     [&](const auto& p) { return p.name == parameter; });
}

std::size_t ModelInfo::parameter_index(std::string_view parameter) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name == parameter) return i;
    names.push_back(parameters[i].name);
  }
  throw Error(name + " has no parameter '" + std::string(parameter) + "'" + suggestion(parameter, names));
}

template <>
const ModelFunctions<float, 4>& model_functions(int model) {
  return compiled[model]->float_4;
}
template <>
const ModelFunctions<double, 3>& model_functions(int model) {
  return compiled[model]->double_3;
}
template <>
const ModelFunctions<Pack, 3>& model_functions(int model) {
  return compiled[model]->pack_3;
}
const ModelDerivatives& model_derivatives(int model) { return compiled[model]->derivatives; }
const FacetFunctions& model_facets(int model) { return compiled[model]->facets; }

} // namespace nacre
