#include "render/light_choice.h"

#include "core/error.h"

#include <cmath>

namespace nacre {

LightChoice::LightChoice(std::vector<LightSummary> lights) : lights_(std::move(lights)) {
  if (lights_.empty()) return;
  double total = 0;
  for (const LightSummary& light : lights_)
    total += light.power;
  if (!std::isfinite(total)) throw Error("the power of a light is not finite");
  std::vector<double> weights;
  for (LightSummary& light : lights_) {
    light.power = total > 0 ? light.power / total : 0.0; // what is squared and divided below stays in float
    weights.push_back(0.5 / double(lights_.size()) + 0.5 * light.power);
  }
  fixed_.emplace(weights);

  constexpr std::size_t most = 64;
  for (std::size_t i = 0; i < lights_.size(); ++i)
    if (!lights_[i].is_far) near_.push_back(int(i));
  if (near_.size() < 2 || near_.size() > most) near_.clear();
  for (const int i : near_)
    near_share_ += fixed_->probability(i);
}

float LightChoice::nearness(const LightSummary& light, const Vec3f& p) const {
  // A light smaller than this is a point; closer to it than this the choice no longer sharpens.
  constexpr float smallest = 1e-12f;
  return float(light.power) / (length_squared(p - light.center) + sqr(light.radius) + smallest);
}

float LightChoice::far_probability(int light) const { return fixed_->probability(light); }

float LightChoice::probability(int light, const Vec3f& p) const {
  const LightSummary& chosen = lights_[std::size_t(light)];
  if (near_.empty() || chosen.is_far) return fixed_->probability(light);
  float sum = 0;
  for (const int i : near_)
    sum += nearness(lights_[std::size_t(i)], p);
  const float equal = 1 / float(near_.size());
  return near_share_ * (sum > 0 ? 0.5f * equal + 0.5f * nearness(chosen, p) / sum : equal);
}

int LightChoice::sample(const Vec3f& p, float u) const {
  if (near_.empty()) return fixed_->sample(u).index;
  if (u >= near_share_) { // the far ones in order; rounding may leave a rest, which is the last one's
    float from = near_share_;
    int last = near_.back();
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      if (!lights_[i].is_far) continue;
      last = int(i);
      from += fixed_->probability(last);
      if (u < from) break;
    }
    return last;
  }
  u /= near_share_;
  const auto count = float(near_.size());
  if (u < 0.5f) return near_[std::min(std::size_t(2 * u * count), near_.size() - 1)];
  float sum = 0;
  for (const int i : near_)
    sum += nearness(lights_[std::size_t(i)], p);
  if (!(sum > 0)) return near_[std::min(std::size_t((2 * u - 1) * count), near_.size() - 1)];
  float rest = (2 * u - 1) * sum;
  int last = near_[0];
  for (const int i : near_) {
    const float weight = nearness(lights_[std::size_t(i)], p);
    if (!(weight > 0)) continue;
    last = i;
    if (rest < weight) break;
    rest -= weight;
  }
  return last;
}

} // namespace nacre
