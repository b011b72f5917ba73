#pragma once
// The closed list of models. Adding a model is one header in bsdf/models and one line here.

#include "bsdf/models/ggx_schlick.h"
#include "bsdf/models/lambert.h"
#include "bsdf/models/oren_nayar.h"
#include "bsdf/models/rough_conductor.h"
#include "bsdf/models/rough_dielectric.h"
#include "bsdf/models/rough_plastic.h"
#include "bsdf/models/smooth_conductor.h"
#include "bsdf/models/smooth_dielectric.h"
#include "bsdf/models/smooth_plastic.h"

#include <string>
#include <variant>
#include <vector>

namespace nacre {

/// Any model of the list, as a value. @tparam Use what to make of the models: std::variant, a tuple, a typed
/// test
template <class R, int C, template <class...> class Use = std::variant>
using Models = Use<           //
    Lambert<R, C>,            //
    OrenNayar<R, C>,          //
    SmoothConductor<R, C>,    //
    GgxConductor<R, C>,       //
    BeckmannConductor<R, C>,  //
    GgxSchlick<R, C>,         //
    SmoothDielectric<R, C>,   //
    GgxDielectric<R, C>,      //
    BeckmannDielectric<R, C>, //
    SmoothPlastic<R, C>,      //
    GgxPlastic<R, C>,         //
    BeckmannPlastic<R, C>>;

struct ParameterInfo {
  std::string name, unit, meaning;
  double lo, hi, initial;
  bool per_channel, fitted;
};
struct ModelInfo {
  std::string name, source, summary;
  Laws laws;
  std::vector<ParameterInfo> parameters;
};

/// What every model of the list declares, in the list's order.
const std::vector<ModelInfo>& model_infos();
/// @throws Error that suggests the nearest name
const ModelInfo& find_model(std::string_view name);
int model_index(std::string_view name); ///< @copydoc find_model

/// The model with this index as Models<R, C>, every parameter at its default.
template <class R, int C>
Models<R, C> make_default_model(int index) {
  constexpr std::size_t n = std::variant_size_v<Models<R, C>>;
  Models<R, C> model;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((int(I) == index ? void(model = default_model<std::variant_alternative_t<I, Models<R, C>>>()) : void()),
     ...);
  }
  (std::make_index_sequence<n>{});
  return model;
}

} // namespace nacre
