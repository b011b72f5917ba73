#pragma once
// What a surface scatters: a weighted sum of up to three lobes, each a model of the list or a measured table.
// A plain value that knows nothing of scenes or memory; renderer, plots and validator evaluate this one type.

#include "bsdf/list.h"
#include "measured/merl_brdf.h"

#include <array>
#include <cassert>

namespace nacre {

template <class... M>
struct AppendMeasured {
  template <class R, int C>
  using Variant = std::variant<M..., MerlBrdf<R, C>>;
};

/// Any model of the list, or a measured one.
template <class R, int C>
using AnyModel = typename Models<R, C, AppendMeasured>::template Variant<R, C>;

/// std::visit, but seen through by the compiler: beyond eleven alternatives that one calls by pointer, which
/// for a simple model costs more than the model.
template <std::size_t I = 0, class F, class Variant>
decltype(auto) visit_inlined(const F& f, const Variant& variant) {
  if constexpr (I + 1 < std::variant_size_v<Variant>)
    if (variant.index() != I) return visit_inlined<I + 1>(f, variant);
  return f(*std::get_if<I>(&variant));
}

template <class R, int C>
class Bsdf {
public:
  using Number = R;
  using Color = Spectrum<R, C>;
  static constexpr int channel_count = C;
  static constexpr int max_lobes = 3;

  Bsdf() = default;
  explicit Bsdf(const AnyModel<R, C>& model) { add(model); }

  /// @param model      one of the alternatives, or AnyModel itself
  /// @param weight     factor on the lobe's f
  /// @param selection  how often `sample` chooses it, relative to the other lobes; > 0
  template <class Model>
  void add(const Model& model, float weight = 1, float selection = 1) {
    assert(count_ < max_lobes && selection > 0);
    lobes_[count_] = model;
    weights_[count_] = weight;
    selections_[count_] = selection;
    total_selection_ += selection;
    ++count_;
  }
  int count() const { return count_; }
  const AnyModel<R, C>& lobe(int i) const { return lobes_[i]; }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    Color f;
    for (int i = 0; i < count_; ++i)
      f += visit_inlined([&](const auto& m) { return m.eval(wo, wi); }, lobes_[i]) * R(weights_[i]);
    return f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    R p(0);
    for (int i = 0; i < count_; ++i)
      p = p + visit_inlined([&](const auto& m) { return m.pdf(wo, wi); }, lobes_[i]) * R(probability(i));
    return p;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    if (count_ == 1)
      return visit_inlined(
          [&](const auto& m) {
            auto s = m.sample(wo, u_lobe, u);
            s.f = s.f * R(weights_[0]);
            return s;
          },
          lobes_[0]);
    BsdfSample<R, C> chosen{{R(0), R(0), R(1)}, Color(), R(0), mask_t<R>(false)};
    float below = 0; // the part of [0, 1) that belongs to lobes before this one
    for (int i = 0; i < count_; ++i) {
      const float p = probability(i);
      const auto mine = (u_lobe >= R(below)) & ((u_lobe < R(below + p)) | mask_t<R>(i == count_ - 1));
      below += p;
      if (!any(mine)) continue;
      const R reused = clamp((u_lobe - R(below - p)) / R(p), 0.0f, 0.99999994f);
      auto s = sample_lobe(i, wo, reused, u);
      // A delta direction belongs to its lobe alone; any other is seen by all lobes.
      const auto sampled = s.pdf > R(0);
      const auto shared = sampled & (!s.is_delta);
      s.f = select(shared, eval(wo, s.wi), s.f * R(weights_[i]));
      s.pdf = select(shared, pdf(wo, s.wi), s.pdf * R(p));
      chosen = {select(mine, s.wi, chosen.wi), select(mine, s.f, chosen.f), select(mine, s.pdf, chosen.pdf),
                mask_t<R>((mine & s.is_delta) | ((!mine) & chosen.is_delta))};
    }
    return chosen;
  }

private:
  float probability(int i) const { return selections_[i] / total_selection_; }
  BsdfSample<R, C> sample_lobe(int i, const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    return visit_inlined([&](const auto& m) { return m.sample(wo, u_lobe, u); }, lobes_[i]);
  }

  std::array<AnyModel<R, C>, max_lobes> lobes_;
  std::array<float, max_lobes> weights_{}, selections_{};
  float total_selection_ = 0;
  int count_ = 0;
};

} // namespace nacre
