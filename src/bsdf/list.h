#pragma once
// The closed list of models. Adding a model is one header in bsdf/models and one line here.

#include "bsdf/parameter.h"

#include <string>
#include <vector>

// X(class template <R, C>, its header in bsdf/models). The build makes one source a header from these lines,
// which compiles the models for every number type (bsdf/compile_model.h), and one that tests them.
#define NACRE_MODELS(X)                                                                                      \
  X(Lambert, lambert)                                                                                        \
  X(OrenNayar, oren_nayar)                                                                                   \
  X(SmoothConductor, smooth_conductor)                                                                       \
  X(GgxConductor, rough_conductor)                                                                           \
  X(BeckmannConductor, rough_conductor)                                                                      \
  X(GgxSchlick, ggx_schlick)                                                                                 \
  X(SmoothDielectric, smooth_dielectric)                                                                     \
  X(GgxDielectric, rough_dielectric)                                                                         \
  X(BeckmannDielectric, rough_dielectric)                                                                    \
  X(SmoothPlastic, smooth_plastic)                                                                           \
  X(GgxPlastic, rough_plastic)                                                                               \
  X(BeckmannPlastic, rough_plastic)

namespace nacre {

struct ParameterInfo {
  std::string name, unit, meaning;
  double lo, hi, initial;
  bool per_channel, fitted;
};
struct ModelInfo {
  std::string name, source, summary;
  Laws laws;
  std::vector<ParameterInfo> parameters;

  /// Place of a parameter. @throws Error that suggests the nearest name
  std::size_t parameter_index(std::string_view parameter) const;
  bool has(std::string_view parameter) const;
};

/// What every model of the list declares, in the list's order.
const std::vector<ModelInfo>& model_infos();
/// @throws Error that suggests the nearest name
const ModelInfo& find_model(std::string_view name);
int model_index(std::string_view name); ///< @copydoc find_model

} // namespace nacre
