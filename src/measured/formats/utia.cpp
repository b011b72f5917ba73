#include "measured/formats/utia.h"

#include "core/error.h"
#include "measured/angle_grid.h"

#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr std::size_t thetas = 6, phis = 48, plane = thetas * phis * thetas * phis;
constexpr std::size_t file_bytes = 3 * plane * sizeof(double);

} // namespace

bool is_utia(std::span<const std::uint8_t> bytes) { return bytes.size() == file_bytes; }

std::shared_ptr<const MeasuredBsdf> parse_utia(std::span<const std::uint8_t> bytes, std::string_view name) {
  if (bytes.size() != file_bytes)
    throw Error::in_binary(name, std::min(bytes.size(), file_bytes),
                           fmt::format("expected {} bytes (3 x 6 x 48 x 6 x 48 doubles of the UTIA BRDF "
                                       "Database), found {}",
                                       file_bytes, bytes.size()));
  std::size_t negative = 0;
  const auto stored = [&](std::size_t channel, std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
    const std::size_t offset = (channel * plane + ((i * phis + j) * thetas + k) * phis + l) * sizeof(double);
    double x;
    std::memcpy(&x, bytes.data() + offset, sizeof x);
    if (!(std::abs(x) < 1e36))
      throw Error::in_binary(name, offset, fmt::format("expected a finite reflectance, found {}", x));
    negative += x < 0 && i > 0;
    return std::max(x, 0.0);
  };
  std::vector<float> values;
  values.reserve(3 * plane);
  for (std::size_t i = 0; i < thetas; ++i)
    for (std::size_t j = 0; j < phis; ++j)
      for (std::size_t k = 0; k < thetas; ++k)
        for (std::size_t l = 0; l < phis; ++l)
          for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t phi_v = (l + j) % phis; // l is phi_v - phi_i
            double x = 0;
            if (i > 0)
              x = stored(c, i, j, k, phi_v);
            else
              for (std::size_t any = 0; any < phis; ++any)
                x += stored(c, i, any, k, phi_v) / double(phis);
            values.push_back(float(x));
          }
  AngleGrid::Nodes nodes;
  for (std::size_t i = 0; i < thetas; ++i)
    nodes.theta_i.push_back(double(i) * pi / 12);
  for (std::size_t j = 0; j < phis; ++j)
    nodes.phi_i.push_back(double(j) * pi / 24);
  nodes.theta_o = nodes.theta_i;
  nodes.phi_o = nodes.phi_i;
  nodes.holds_beyond_ends = true;
  std::vector<std::pair<std::string, std::string>> facts;
  if (negative > 0)
    facts.emplace_back("negative numbers", fmt::format("{} at theta_i > 0, read as 0", negative));
  return std::make_shared<const AngleGrid>(std::move(nodes), Channels::rgb(), std::move(values),
                                           "anisotropic reflectance table (UTIA)", std::move(facts));
}

} // namespace nacre
