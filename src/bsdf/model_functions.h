#pragma once
// The models of the list as functions of their parameter vectors, for who knows the model at run time alone:
// one call by pointer, then the model's own code with everything inlined. No header of a model is needed.

#include "bsdf/model.h"
#include "core/dual.h"

#include <memory>
#include <span>

namespace nacre {

/// A parameter vector is as from_vector takes it: declared order, channels of a parameter side by side.
template <class R, int C>
struct ModelFunctions {
  using Color = Spectrum<R, C>;
  Color (*eval)(const R* values, const Vec3<R>& wo, const Vec3<R>& wi);
  R (*pdf)(const R* values, const Vec3<R>& wo, const Vec3<R>& wi);
  BsdfSample<R, C> (*sample)(const R* values, const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u);
  /// For who evaluates many directions with values that are the same in all lanes of a pack: what `eval`
  /// needs of the values alone and takes long to find, and the same to within 1e-5 with its help. Null where
  /// there is no such thing.
  std::shared_ptr<const void> (*prepare)(const R* values) = nullptr;
  Color (*eval_prepared)(const R* values, const void* prepared, const Vec3<R>& wo,
                         const Vec3<R>& wi) = nullptr;
};

/// R, C: float, 4 (the renderer); Pack, 3 (plots); double, 3 (validation, reference).
/// @param model  index into model_infos()
template <class R, int C>
const ModelFunctions<R, C>& model_functions(int model);

/// The longest parameter vector of any model: C numbers for a colour.
template <int C>
inline constexpr int max_parameter_numbers = 10 * C + 40;

/// Directions as arrays of coordinates, x, y and z.
struct DirectionArrays {
  std::array<const float*, 3> wo, wi;
};

/// f of a model in one channel, many directions at once, and its exact derivatives by dual numbers over
/// packs: channels do not mix in eval, and a dual number for one channel carries only what this channel
/// depends on.
struct ModelDerivatives {
  int count; ///< parameters that are declared fitted
  /// f of `n` directions, a multiple of pack_width, and its derivatives: that by parameters[k] in direction i
  /// at df[k n + i]. `df` may be null: then f alone is computed.
  /// @param values      one a declared parameter
  /// @param parameters  which to differentiate by, places in declared order, ascending
  void (*evaluate)(std::span<const double> values, std::span<const int> parameters, const DirectionArrays& at,
                   std::size_t n, float* f, float* df);
};

/// @param model  index into model_infos()
const ModelDerivatives& model_derivatives(int model);

/// The microsurface of a model made of facets, for the parameter vector of three channels; null where a model
/// has none. Such a model offers `distribution()` with D and lambda_cos, and where its masking is not Smith's
/// also `masking(w, wm)` and `masking_shadowing(wo, wi)`.
struct FacetFunctions {
  double (*D)(const double* values, const Vec3d& wm) = nullptr; ///< 1/sr
  double (*G1)(const double* values, const Vec3d& w, const Vec3d& wm) = nullptr;
  double (*G2)(const double* values, const Vec3d& wo, const Vec3d& wi) = nullptr; ///< at their half vector
};
const FacetFunctions& model_facets(int model);

} // namespace nacre
