#include "measured/user_bsdf.h"

#include "core/error.h"
#include "core/random.h"
#include "core/warp.h"

#include <fmt/format.h>

namespace nacre {

UserBsdf::UserBsdf(std::shared_ptr<const UserModel> model, std::vector<std::array<double, 3>> values)
    : model_(std::move(model)), values_(std::move(values)) {
  const ModelInfo& info = model_->info();
  if (values_.size() != info.parameters.size())
    throw Error(fmt::format("{}: expected {} parameters, found {}", info.name, info.parameters.size(),
                            values_.size()));
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const ParameterInfo& p = info.parameters[i];
    for (std::size_t c = 0; c < (p.per_channel ? 3 : 1); ++c) {
      const double x = values_[i][c];
      if (!(x >= p.lo && x <= p.hi))
        throw Error(
            fmt::format("{}: {} = {} lies outside its domain [{}, {}]", info.name, p.name, x, p.lo, p.hi));
      vector_.push_back(x);
      pack_vector_.push_back(constant<Pack>(x));
    }
  }
}

bool UserBsdf::is_isotropic() const {
  std::call_once(tried_, [&] {
    for (int n = 0; n < 300 && isotropic_; ++n) {
      const auto u = [n](int d) { return unit_double(hash(23, n, d)); };
      // About the mirror direction, where narrow lobes are, as well as anywhere.
      const double theta = 0.49 * pi * u(0), spread = n % 2 == 0 ? 0.02 : 0.5, turn = 2 * pi * u(3);
      const double theta_i = std::clamp(theta + spread * (u(1) - 0.5), 0.0, 0.49 * pi);
      const double phi = 2 * pi * u(4), phi_i = phi + pi + 2 * spread * (u(2) - 0.5);
      const auto f = rgb(spherical_direction(theta, phi), spherical_direction(theta_i, phi_i));
      const auto g = rgb(spherical_direction(theta, phi + turn), spherical_direction(theta_i, phi_i + turn));
      for (std::size_t c = 0; c < 3; ++c)
        isotropic_ = isotropic_ && !(std::abs(f[c] - g[c]) > 1e-6 * std::max(f[c], g[c]) + 1e-12);
    }
  });
  return isotropic_;
}

bool UserBsdf::is_tabulated() const {
  std::call_once(counted_, [&] { tabulated_ = operations() <= most_operations_to_tabulate; });
  return tabulated_;
}

double UserBsdf::pdf(const Vec3d& wo, const Vec3d& wi) const {
  if (is_tabulated()) return MeasuredBsdf::pdf(wo, wi);
  return same_upper_side(wo, wi) ? wi.z * inv_pi : 0;
}

Vec3d UserBsdf::sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const {
  return is_tabulated() ? MeasuredBsdf::sample(wo, u_lobe, u) : square_to_cosine_hemisphere(u);
}

std::vector<std::pair<std::string, std::string>> UserBsdf::facts() const {
  std::vector<std::pair<std::string, std::string>> facts;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const ParameterInfo& p = model_->info().parameters[i];
    const auto& v = values_[i];
    facts.emplace_back(p.name,
                       p.per_channel ? fmt::format("{}/{}/{}", v[0], v[1], v[2]) : fmt::format("{}", v[0]));
  }
  return facts;
}

const Channels& UserBsdf::channels() const {
  static const Channels rgb = Channels::rgb();
  return rgb;
}

std::array<double, 3> UserBsdf::rgb(const Vec3d& wo, const Vec3d& wi) const {
  const auto f = model_->eval<double>(vector_, wo, wi);
  return {std::max(f[0], 0.0), std::max(f[1], 0.0), std::max(f[2], 0.0)};
}

bool UserBsdf::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  const auto value = model_->eval<double>(vector_, wo, wi);
  for (std::size_t c = 0; c < 3; ++c)
    f[c] = float(value[int(c)]);
  return sides().contain(wo, wi);
}

Spectrum<Pack, 3> UserBsdf::eval(const Vec3<Pack>& wo, const Vec3<Pack>& wi) const {
  auto f = model_->eval<Pack>(pack_vector_, wo, wi);
  for (int c = 0; c < 3; ++c)
    f[c] =
        select(f[c] < Pack(0.0f), Pack(0.0f), f[c]); // what is no number stays, for plots to show as a hole
  return f;
}

} // namespace nacre
