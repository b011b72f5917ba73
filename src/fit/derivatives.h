#pragma once
// f of a model of the list and its exact derivatives, many directions at once, with the model chosen at run
// time. The model is instantiated for one channel with dual numbers over packs: channels do not mix in eval,
// and a dual number for one channel carries only the few parameters that this channel depends on.

#include "bsdf/list.h"
#include "fit/observations.h"

#include <span>

namespace nacre {

/// Declared parameters of a model with `fitted` true: as many derivatives has an evaluation in one channel.
template <class M>
constexpr int fitted_count() {
  int n = 0;
  for_each_parameter<M>([&](const auto& p) { n += p.fitted; });
  return n;
}

/// The model M of one channel whose k-th fitted parameter is the k-th variable of its dual numbers.
/// @param values  one a declared parameter
template <class M>
M with_variables(std::span<const double> values) {
  using R = typename M::Number;
  M model;
  std::size_t next = 0;
  int variable = 0;
  for_each_parameter<M>([&](const auto& p) {
    const auto x = constant<value_t<R>>(values[next++]);
    const R number = p.fitted ? R::variable(x, variable++) : R(x);
    model.*p.member = std::remove_reference_t<decltype(model.*p.member)>(number);
  });
  return model;
}

struct LobeDerivatives {
  int count; ///< derivatives of f, one a fitted parameter, in declared order
  /// f of `n` directions from `begin`, both multiples of pack_width, and their derivatives: derivative k of
  /// direction i at df[k n + i]. `df` may be null: then f alone is computed.
  void (*evaluate)(std::span<const double> values, const Observations& at, std::size_t begin, std::size_t n,
                   float* f, float* df);
};

/// @param model  index into model_infos()
const LobeDerivatives& lobe_derivatives(int model);

} // namespace nacre
