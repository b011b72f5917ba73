#pragma once
// A user-written model with its parameters at fixed values, as scattering like any measurement: so it is
// evaluated, plotted, validated and rendered wherever measurements are.

#include "bsdf/user_model.h"
#include "measured/measured_bsdf.h"

#include <mutex>

namespace nacre {

class UserBsdf final : public MeasuredBsdf {
public:
  /// @param values  one a declared parameter; a scalar parameter has it three times
  /// @throws Error for a wrong number of them, or one outside its domain
  UserBsdf(std::shared_ptr<const UserModel> model, std::vector<std::array<double, 3>> values);

  const UserModel& model() const { return *model_; }
  const std::vector<std::array<double, 3>>& values() const { return values_; }
  /// What a value takes, see UserModel.
  std::size_t operations() const { return model_->operations(vector_); }

  std::string kind() const override { return "user-written model (.brdf)"; }
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override;
  /// Whether the values stay where both directions turn about the normal: found by trying some hundred pairs,
  /// at the first call. A wrong answer costs samples, not truth.
  bool is_isotropic() const override;
  /// True above the surface. @throws Error with the line for a shader that fails while it runs
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  /// None: nothing was measured.
  MeasuredSamples samples() const override { return {}; }
  std::array<double, 3> rgb(const Vec3d& wo, const Vec3d& wi) const override;

  /// By a table of the shader's own lobes; by the cosine where a value takes so many operations that the
  /// table would take minutes.
  double pdf(const Vec3d& wo, const Vec3d& wi) const override;
  Vec3d sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const override;
  static constexpr std::size_t most_operations_to_tabulate = 4000;

  /// f of many directions at once, linear RGB, no channel below 0.
  Spectrum<Pack, 3> eval(const Vec3<Pack>& wo, const Vec3<Pack>& wi) const;

private:
  std::shared_ptr<const UserModel> model_;
  std::vector<std::array<double, 3>> values_;
  std::vector<double> vector_;    ///< as UserModel::eval takes it
  std::vector<Pack> pack_vector_; ///< the same
  bool is_tabulated() const;
  mutable std::once_flag tried_, counted_;
  mutable bool isotropic_ = true, tabulated_ = true;
};

} // namespace nacre
