#pragma once
// What a surface scatters: a weighted sum of up to four lobes, each a model of the list or a measurement.
// A plain value that knows nothing of scenes or memory; renderer, plots and validator evaluate this one type.

#include "bsdf/list.h"
#include "bsdf/model_functions.h"
#include "measured/measured_lobe.h"

#include <array>
#include <cassert>

namespace nacre {

/// A model of the list with its parameters, or a measurement.
template <class R, int C>
class BsdfLobe {
public:
  BsdfLobe() = default;
  /// @param model   index into model_infos()
  /// @param values  the parameter vector, as from_vector takes it
  BsdfLobe(int model, std::span<const R> values) : functions_(&model_functions<R, C>(model)) {
    std::copy(values.begin(), values.end(), values_.begin());
  }
  explicit BsdfLobe(const MeasuredLobe<R, C>& measured) : measured_(measured) {}
  /// Makes eval fast for many directions, in packs with the same parameters in all lanes; see ModelFunctions.
  void prepare() {
    if constexpr (in_packs)
      if (functions_ && functions_->prepare) prepared_ = functions_->prepare(values_.data());
  }
  Spectrum<R, C> eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    if constexpr (in_packs)
      if (prepared_) return functions_->eval_prepared(values_.data(), prepared_.get(), wo, wi);
    return functions_ ? functions_->eval(values_.data(), wo, wi) : measured_.eval(wo, wi);
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return functions_ ? functions_->pdf(values_.data(), wo, wi) : measured_.pdf(wo, wi);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    return functions_ ? functions_->sample(values_.data(), wo, u_lobe, u) : measured_.sample(wo, u_lobe, u);
  }

private:
  static constexpr bool in_packs = std::is_same_v<R, Pack>;
  struct Nothing {};

  const ModelFunctions<R, C>* functions_ = nullptr; ///< null: measured
  [[no_unique_address]] std::conditional_t<in_packs, std::shared_ptr<const void>, Nothing> prepared_;
  std::array<R, max_parameter_numbers<C>> values_;
  MeasuredLobe<R, C> measured_;
};

template <class R, int C>
class Bsdf {
public:
  using Number = R;
  using Color = Spectrum<R, C>;
  static constexpr int channel_count = C;
  static constexpr int max_lobes = 4;

  /// @param weight     factor on the lobe's f
  /// @param selection  how often `sample` chooses it, relative to the other lobes; > 0
  void add(const BsdfLobe<R, C>& lobe, float weight = 1, float selection = 1) {
    assert(count_ < max_lobes && selection > 0);
    lobes_[count_] = lobe;
    weights_[count_] = weight;
    selections_[count_] = selection;
    total_selection_ += selection;
    ++count_;
  }
  int count() const { return count_; }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    Color f;
    for (int i = 0; i < count_; ++i)
      f += lobes_[i].eval(wo, wi) * R(weights_[i]);
    return f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    R p(0);
    for (int i = 0; i < count_; ++i)
      p = p + lobes_[i].pdf(wo, wi) * R(probability(i));
    return p;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    if (count_ == 1) {
      auto s = lobes_[0].sample(wo, u_lobe, u);
      s.f = s.f * R(weights_[0]);
      return s;
    }
    BsdfSample<R, C> chosen{{R(0), R(0), R(1)}, Color(), R(0), mask_t<R>(false)};
    float below = 0; // the part of [0, 1) that belongs to lobes before this one
    for (int i = 0; i < count_; ++i) {
      const float p = probability(i);
      const auto mine = (u_lobe >= R(below)) & ((u_lobe < R(below + p)) | mask_t<R>(i == count_ - 1));
      below += p;
      if (!any(mine)) continue;
      const R reused = clamp((u_lobe - R(below - p)) / R(p), 0.0f, 0.99999994f);
      auto s = lobes_[i].sample(wo, reused, u);
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

  std::array<BsdfLobe<R, C>, max_lobes> lobes_;
  std::array<float, max_lobes> weights_{}, selections_{};
  float total_selection_ = 0;
  int count_ = 0;
};

} // namespace nacre
