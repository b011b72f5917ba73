#include "measured/conversion.h"

#include "core/error.h"
#include "core/random.h"
#include "core/warp.h"
#include "measured/inspection.h"
#include "measured/rusinkiewicz.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace nacre {
namespace {

std::string words(const Channels& channels) {
  if (channels.is_rgb()) return "RGB";
  if (!channels.is_spectral()) return "one grey channel";
  return fmt::format("{} wavelengths from {:g} to {:g} nm", channels.count(),
                     channels.wavelengths_nm().front(), channels.wavelengths_nm().back());
}

bool same(const Channels& a, const Channels& b) {
  return a.count() == b.count() && a.wavelengths_nm() == b.wavelengths_nm();
}

DirectionPair<double> random_pair(int n) {
  const auto u = [n](int d) { return unit_double(hash(29, n, d)); };
  if (n % 2 == 0) return {square_to_hemisphere(Vec2d{u(0), u(1)}), square_to_hemisphere(Vec2d{u(2), u(3)})};
  const auto pair = directions(HalfDifference<double>{pi / 2 * sqr(u(0)), pi / 2 * u(1), 2 * pi * u(2)});
  const double c = std::cos(2 * pi * u(3)), s = std::sin(2 * pi * u(3));
  const auto turned = [&](const Vec3d& w) { return Vec3d{c * w.x - s * w.y, s * w.x + c * w.y, w.z}; };
  return {turned(pair.wo), turned(pair.wi)};
}

std::vector<std::string> changes_of(const MeasuredBsdf& before, const MeasuredBsdf& after) {
  std::vector<std::string> changes;
  if (!same(before.channels(), after.channels()))
    changes.push_back(
        fmt::format("channels: {} became {}", words(before.channels()), words(after.channels())));
  if (!before.is_isotropic() && after.is_isotropic())
    changes.emplace_back("anisotropy: the mean over azimuths is left");
  const auto kept = side_pairs(after.sides());
  for (const SidePair& pair : side_pairs(before.sides()))
    if (std::none_of(kept.begin(), kept.end(), [&](const SidePair& k) { return k.name == pair.name; }))
      changes.push_back(fmt::format("{}: gone", pair.name));
  return changes;
}

} // namespace

const MeasuredFormat& format_to_write(const std::string& path, const std::string& name) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  std::vector<std::string> names, endings;
  for (const MeasuredFormat& f : measured_formats()) {
    const bool asked = name.empty() ? std::find(f.endings.begin(), f.endings.end(), ending) != f.endings.end()
                                    : f.name == name;
    if (asked && f.encode) return f;
    if (asked && !name.empty()) throw UsageError(fmt::format("the format '{}' is read, not written", name));
    if (!f.encode) continue;
    names.emplace_back(f.name);
    endings.insert(endings.end(), f.endings.begin(), f.endings.end());
  }
  if (!name.empty())
    throw UsageError(fmt::format("no format '{}' is written{}", name, suggestion(name, names)));
  throw UsageError(fmt::format("{}: no measurement is written with the ending '{}'{}", path, ending,
                               suggestion(ending, endings)));
}

ConversionLoss conversion_loss(const MeasuredBsdf& before, const MeasuredBsdf& after, int pairs) {
  ConversionLoss loss;
  loss.changes = changes_of(before, after);
  const bool by_channel = same(before.channels(), after.channels());
  std::vector<float> a(std::size_t(before.channels().count())), b(std::size_t(after.channels().count()));
  const std::vector<SidePair> sides = side_pairs(before.sides());
  int compared = 0;
  for (int n = 0; compared < pairs && !sides.empty(); ++n) {
    auto [wo, wi] = random_pair(n);
    if (!(wo.z > 0 && wi.z > 0)) continue;
    const SidePair& pair = sides[std::size_t(compared++) % sides.size()];
    if (!pair.wo_front) wo.z = -wo.z;
    if (!pair.wi_front) wi.z = -wi.z;
    const bool was = before.evaluate(wo, wi, a), is = after.evaluate(wo, wi, b);
    loss.lost += was && !is;
    loss.gained += is && !was;
    if (!was || !is) continue;
    double difference = 0, sum = 0;
    const auto add = [&](double x, double y) {
      difference += std::abs(x - y), sum += std::abs(x) + std::abs(y);
    };
    if (by_channel) {
      for (std::size_t c = 0; c < a.size(); ++c)
        add(double(a[c]), double(b[c]));
    } else {
      const auto x = before.channels().to_rgb(a), y = after.channels().to_rgb(b);
      for (std::size_t c = 0; c < 3; ++c)
        add(x[c], y[c]);
    }
    ++loss.pairs;
    const double e = sum > 0 ? difference / (0.5 * sum) : 0;
    loss.mean += e;
    if (e > loss.worst) loss.worst = e, loss.wo = wo, loss.wi = wi;
  }
  if (loss.pairs > 0) loss.mean /= double(loss.pairs);
  return loss;
}

} // namespace nacre
