#include "bsdf/list.h"

#include "core/error.h"

namespace nacre {
namespace {

template <class M>
ModelInfo describe() {
  static_assert(ScatteringModel<M>);
  ModelInfo info{std::string(M::name), std::string(M::source), std::string(M::summary), M::laws, {}};
  for_each_parameter<M>([&](const auto& p) {
    info.parameters.push_back({std::string(p.name), std::string(p.unit), std::string(p.meaning), p.lo, p.hi,
                               p.initial, p.per_channel, p.fitted});
  });
  return info;
}

template <class... M>
struct Describe {
  static std::vector<ModelInfo> all() { return {describe<M>()...}; }
};

} // namespace

const std::vector<ModelInfo>& model_infos() {
  static const std::vector<ModelInfo> infos = Models<float, 3, Describe>::all();
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

} // namespace nacre
