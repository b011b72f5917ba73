#include "fit/derivatives.h"

#include "core/dual.h"

#include <utility>

namespace nacre {
namespace {

template <class R>
Vec3<R> direction(const std::array<std::vector<float>, 3>& w, std::size_t i) {
  return {R(load(&w[0][i])), R(load(&w[1][i])), R(load(&w[2][i]))};
}

/// The model at position I of the list.
template <std::size_t I, class R>
using Listed = std::variant_alternative_t<I, Models<R, 1>>;

template <std::size_t I>
struct Evaluator {
  static constexpr int count = fitted_count<Listed<I, float>>();
  using Values = Listed<I, Pack>;
  using Duals = Listed<I, Dual<Pack, count>>;

  static void evaluate(std::span<const double> values, const Observations& at, std::size_t begin,
                       std::size_t n, float* f, float* df) {
    if (df)
      with_derivatives(with_variables<Duals>(values), at, begin, n, f, df);
    else
      values_alone(values, at, begin, n, f);
  }

private:
  static void with_derivatives(const Duals& model, const Observations& at, std::size_t begin, std::size_t n,
                               float* f, float* df) {
    using R = typename Duals::Number;
    for (std::size_t i = 0; i < n; i += pack_width) {
      const R y = model.eval(direction<R>(at.wo, begin + i), direction<R>(at.wi, begin + i))[0];
      store(f + i, y.v);
      for (int k = 0; k < count; ++k)
        store(df + std::size_t(k) * n + i, y.d[std::size_t(k)]);
    }
  }
  static void values_alone(std::span<const double> values, const Observations& at, std::size_t begin,
                           std::size_t n, float* f) {
    std::vector<Pack> packs;
    for (const double x : values)
      packs.push_back(constant<Pack>(x));
    const Values model = from_vector<Values>(packs.data());
    for (std::size_t i = 0; i < n; i += pack_width)
      store(f + i, model.eval(direction<Pack>(at.wo, begin + i), direction<Pack>(at.wi, begin + i))[0]);
  }
};

template <std::size_t... I>
const LobeDerivatives& entry(int model, std::index_sequence<I...>) {
  static constexpr std::array<LobeDerivatives, sizeof...(I)> table{
      LobeDerivatives{Evaluator<I>::count, &Evaluator<I>::evaluate}...};
  return table.at(std::size_t(model));
}

} // namespace

const LobeDerivatives& lobe_derivatives(int model) {
  return entry(model, std::make_index_sequence<std::variant_size_v<Models<Pack, 1>>>());
}

} // namespace nacre
