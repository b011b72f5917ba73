#include "measured/formats/ngan.h"

#include "core/error.h"
#include "measured/angle_grid.h"

#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>

namespace nacre {
namespace {

constexpr std::size_t header_bytes = 64;
constexpr std::int32_t most_bins = 4096;
constexpr const char* counted[] = {"theta_in", "theta_out", "phi_diff", "phi_in"};

std::array<std::int32_t, 16> header_of(std::span<const std::uint8_t> bytes) {
  std::array<std::int32_t, 16> header{};
  std::memcpy(header.data(), bytes.data(), std::min(bytes.size(), header_bytes));
  return header;
}

std::vector<double> middles(std::int32_t bins, double range) {
  std::vector<double> nodes;
  for (std::int32_t i = 0; i < bins; ++i)
    nodes.push_back((i + 0.5) * range / bins);
  return nodes;
}

} // namespace

bool is_ngan(std::span<const std::uint8_t> bytes) {
  const auto h = header_of(bytes);
  return bytes.size() >= header_bytes && h[6] == 1 && h[7] == 0 && h[10] == 3;
}

std::shared_ptr<const MeasuredBsdf> parse_ngan(std::span<const std::uint8_t> bytes, std::string_view name) {
  if (bytes.size() < header_bytes)
    throw Error::in_binary(
        name, bytes.size(),
        fmt::format("expected a header of {} bytes, found {}", header_bytes, bytes.size()));
  const auto header = header_of(bytes);
  for (int d = 0; d < 4; ++d)
    if (header[d] < 1 || header[d] > most_bins)
      throw Error::in_binary(
          name, d * 4u, fmt::format("{} bins of {}, expected 1 to {}", header[d], counted[d], most_bins));
  const auto expect = [&](int at, std::int32_t wanted, const char* what) {
    if (header[at] != wanted)
      throw Error::in_binary(name, at * 4u, fmt::format("{} is {}, expected {}", what, header[at], wanted));
  };
  expect(6, 1, "the kind of angles");
  expect(7, 0, "the kind of bins");
  expect(10, 3, "the number of channels");
  if (header[9] != 0 && header[9] != 1)
    throw Error::in_binary(name, 36, fmt::format("the range of phi_diff is {}, expected 0 or 1", header[9]));
  std::array<std::size_t, 4> n;
  std::size_t cells = 1;
  for (int d = 0; d < 4; ++d) {
    n[d] = std::size_t(header[d]);
    cells *= n[d]; // at most 2^48
  }
  if (cells > AngleGrid::max_nodes)
    throw Error::in_binary(name, 0, fmt::format("{} bins, expected at most {}", cells, AngleGrid::max_nodes));
  const std::size_t expected = header_bytes + 12 * cells;
  if (bytes.size() != expected)
    throw Error::in_binary(name, std::min(bytes.size(), expected),
                           fmt::format("expected {} bytes for {} x {} x {} x {} bins, found {}", expected,
                                       n[0], n[1], n[2], n[3], bytes.size()));
  std::vector<float> values(3 * cells);
  for (std::size_t i = 0; i < n[0]; ++i)
    for (std::size_t j = 0; j < n[3]; ++j)
      for (std::size_t k = 0; k < n[1]; ++k)
        for (std::size_t l = 0; l < n[2]; ++l) {
          const std::size_t cell = ((i * n[1] + k) * n[2] + l) * n[3] + j;
          float* f = &values[3 * (((i * n[3] + j) * n[1] + k) * n[2] + l)];
          bool measured = true;
          for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t offset = header_bytes + 4 * (c * cells + cell);
            std::memcpy(&f[c], bytes.data() + offset, 4);
            if (!(std::abs(f[c]) < 1e30f))
              throw Error::in_binary(name, offset, fmt::format("expected a finite value, found {}", f[c]));
            measured = measured && f[c] >= 0;
          }
          if (!measured) std::fill_n(f, 3, std::numeric_limits<float>::quiet_NaN());
        }
  AngleGrid::Nodes nodes;
  nodes.theta_i = middles(header[0], pi / 2);
  nodes.theta_o = middles(header[1], pi / 2);
  nodes.phi_i = middles(header[3], 2 * pi);
  nodes.phi_o = middles(header[2], header[9] == 1 ? pi : 2 * pi);
  if (header[9] == 1) nodes.mirror = AngleGrid::Mirror::sample;
  nodes.holds_beyond_ends = true;
  return std::make_shared<const AngleGrid>(
      std::move(nodes), Channels::rgb(), std::move(values), "anisotropic reflectance table (Ngan)",
      std::vector<std::pair<std::string, std::string>>{{"unit", "as stored; the format states none"}});
}

} // namespace nacre
