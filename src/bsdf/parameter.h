#pragma once
// The parameters of a model as data. From these declarations alone come the command line's listing, JSON and
// scene-file names, the fitter's vector with its bounds, the validation sweep and the reference page.

#include "core/spectrum.h"

#include <string_view>
#include <tuple>

namespace nacre {

/// One declared parameter of the model M. T is R (one number) or Spectrum<R, C> (a number a channel).
template <class M, class T>
struct Parameter {
  T M::*member;
  std::string_view name;
  std::string_view unit; ///< "1" if dimensionless
  double lo, hi;         ///< domain, both ends valid; also the bounds of a fit
  double initial;        ///< default, the same in every channel
  std::string_view meaning;
  bool fitted = true; ///< false for a switch: a fit leaves it at its value

  static constexpr bool per_channel = !std::is_same_v<T, typename M::Number>;
  /// Numbers it occupies in a parameter vector.
  static constexpr int size = per_channel ? M::channel_count : 1;
};
template <class M, class T>
Parameter(T M::*, std::string_view, std::string_view, double, double, double, std::string_view)
    -> Parameter<M, T>;
template <class M, class T>
Parameter(T M::*, std::string_view, std::string_view, double, double, double, std::string_view, bool)
    -> Parameter<M, T>;

/// What a model claims of itself; the validator measures it.
struct Laws {
  bool reciprocal = true;
  bool transmits = false;  ///< light also goes through. Unless `thin`, the parameter "eta" is then
                           ///< index inside / index outside
  bool thin = false;       ///< of what transmits: a sheet or fibre with the same medium on both sides
  double energy_gain = 0;  ///< largest amount by which the directional albedo is known to exceed 1
  bool stochastic = false; ///< eval is an unbiased estimate, its randomness drawn from its directions;
                           ///< sample's f |cos| / pdf is one too, and pdf a density near to the sampled one
};

/// Base of a model: says its number type and channel count, and claims all laws unless the model says
/// otherwise.
template <class R, int C>
struct ModelBase {
  using Number = R;
  using Color = Spectrum<R, C>;
  static constexpr int channel_count = C;
  static constexpr Laws laws{};
};

/// Calls f(parameter) for each declared parameter of model M, in order.
template <class M, class F>
constexpr void for_each_parameter(F f) {
  std::apply([&](const auto&... p) { (f(p), ...); }, M::parameters());
}

/// Length of M's parameter vector: a number for a scalar, C numbers for a per-channel parameter.
template <class M>
constexpr int parameter_count() {
  int n = 0;
  for_each_parameter<M>([&](const auto& p) { n += p.size; });
  return n;
}

/// A model from its parameter vector, in declared order, channels of a parameter side by side.
/// @param values  parameter_count<M>() numbers
template <class M>
M from_vector(const typename M::Number* values) {
  M model;
  for_each_parameter<M>([&](const auto& p) {
    if constexpr (p.per_channel)
      for (int i = 0; i < p.size; ++i)
        (model.*p.member)[i] = *values++;
    else
      model.*p.member = *values++;
  });
  return model;
}

/// The model with every parameter at its declared default.
template <class M>
M default_model() {
  M model;
  for_each_parameter<M>([&](const auto& p) {
    using T = std::remove_reference_t<decltype(model.*p.member)>;
    model.*p.member = T(constant<typename M::Number>(p.initial));
  });
  return model;
}

} // namespace nacre
