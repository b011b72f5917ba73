#include "measured/merl_table.h"

#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>

namespace nacre {

namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

constexpr std::size_t header_bytes = 12, bytes_per_cell = 3 * sizeof(double);
constexpr int max_dimension = 4096;
constexpr std::size_t max_cells = std::size_t(1) << 26; // 46 times the original
/// Stored number to 1/sr (Matusik's own reader).
constexpr std::array<double, 3> unit_of_channel{1.0 / 1500, 1.15 / 1500, 1.66 / 1500};
/// Larger than any reflectance, and in range for float after every sum of eight.
constexpr double max_stored = 1e36;
constexpr const char* dimension_names[] = {"n_theta_h", "n_theta_d", "n_phi_d"};

/// Empty if these are the sizes of a table, else what is wrong and with which of the three.
std::pair<std::string, int> dimension_fault(const std::array<std::int64_t, 3>& n) {
  for (int d = 0; d < 3; ++d)
    if (n[d] < 1 || n[d] > max_dimension)
      return {fmt::format("{} is {}, expected 1 to {} (a MERL table is 90 x 90 x 180)", dimension_names[d],
                          n[d], max_dimension),
              d};
  if (static_cast<std::size_t>(n[0]) * n[1] * n[2] > max_cells)
    return {fmt::format("{} x {} x {} entries, expected at most {}", n[0], n[1], n[2], max_cells), 0};
  return {};
}

} // namespace

MerlTable::MerlTable(int n_theta_h, int n_theta_d, int n_phi_d, std::vector<Cell> cells,
                     std::vector<bool> filled)
    : n_theta_h_(n_theta_h), n_theta_d_(n_theta_d), n_phi_d_(n_phi_d), cells_(std::move(cells)),
      filled_(std::move(filled)) {
  if (const auto fault = dimension_fault({n_theta_h, n_theta_d, n_phi_d}).first; !fault.empty())
    throw Error("reflectance table: " + fault);
  const std::size_t expected = static_cast<std::size_t>(n_theta_h) * n_theta_d * n_phi_d;
  if (cells_.size() != expected)
    throw Error(fmt::format("reflectance table: {} x {} x {} needs {} entries, found {}", n_theta_h,
                            n_theta_d, n_phi_d, expected, cells_.size()));
  if (!filled_.empty() && filled_.size() != expected)
    throw Error(fmt::format("reflectance table: {} entries and {} marks", expected, filled_.size()));
  for (const Cell& c : cells_)
    holes_ += c[3] == 0;
  filled_count_ = std::size_t(std::count(filled_.begin(), filled_.end(), true));
}

MerlTable::MerlTable(MerlTable&&) noexcept = default;
MerlTable& MerlTable::operator=(MerlTable&&) noexcept = default;
MerlTable::~MerlTable() = default;

MerlTable MerlTable::tabulate(int n_theta_h, int n_theta_d, int n_phi_d, const Function& f) {
  if (const auto fault = dimension_fault({n_theta_h, n_theta_d, n_phi_d}).first; !fault.empty())
    throw Error("reflectance table: " + fault);
  const std::size_t slab = static_cast<std::size_t>(n_theta_d) * n_phi_d;
  MerlTable table(n_theta_h, n_theta_d, n_phi_d, std::vector<Cell>(slab * n_theta_h));
  parallel_for(n_theta_h, [&](std::size_t i) {
    Cell* cell = &table.cells_[i * slab];
    for (int j = 0; j < n_theta_d; ++j)
      for (int k = 0; k < n_phi_d; ++k, ++cell) {
        const auto a = table.node(static_cast<int>(i), j, k);
        const auto rgb = f(a.theta_h, a.theta_d, a.phi_d);
        for (const double x : rgb)
          if (!(std::abs(x) < max_stored))
            throw Error(fmt::format("reflectance table: value {} at theta_h {} theta_d {} phi_d {} (degrees)",
                                    x, a.theta_h * 180 / pi, a.theta_d * 180 / pi, a.phi_d * 180 / pi));
        if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0)
          *cell = {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2]), 1.0f};
      }
  });
  table.holes_ = 0;
  for (const Cell& c : table.cells_)
    table.holes_ += c[3] == 0;
  return table;
}

std::string MerlTable::kind() const { return "isotropic reflectance table (MERL)"; }

std::vector<std::pair<std::string, std::string>> MerlTable::facts() const {
  return {{"resolution", fmt::format("theta_h {} (square-root spaced), theta_d {}, phi_d {} over {} degrees",
                                     n_theta_h_, n_theta_d_, n_phi_d_, phi_d_period() > 4 ? 360 : 180)}};
}

const Channels& MerlTable::channels() const {
  static const Channels rgb = Channels::rgb();
  return rgb;
}

bool MerlTable::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  std::fill_n(f.begin(), 3, 0.0f);
  if (!(wo.z > 0 && wi.z > 0)) return false;
  const std::array<double, 4> sum = blend(corner(half_difference(wo, wi)));
  if (!(sum[3] > 0)) return false;
  for (std::size_t c = 0; c < 3; ++c)
    f[c] = float(sum[c] / sum[3]);
  return true;
}

double MerlTable::node_weight(int i, int j, int theta_h_step, int theta_d_step) const {
  // Between the midpoints to the neighbours that are kept, within the table.
  const auto faces = [](int at, int step, int n) {
    return std::pair{std::max(0.0, at - 0.5 * step), at + step < n ? at + 0.5 * step : double(n)};
  };
  const auto [h0, h1] = faces(i, theta_h_step, n_theta_h_);
  const auto [d0, d1] = faces(j, theta_d_step, n_theta_d_);
  const auto cos_h = [&](double x) { return std::cos(pi / 2 * sqr(x / n_theta_h_)); };
  const auto sin2_d = [&](double x) { return sqr(std::sin(pi / 2 * x / n_theta_d_)); };
  return (cos_h(h0) - cos_h(h1)) * (sin2_d(d1) - sin2_d(d0));
}

MeasuredSamples MerlTable::samples() const {
  MeasuredSamples s;
  for (int i = 0; i < n_theta_h_; ++i)
    for (int j = 0; j < n_theta_d_; ++j)
      for (int k = 0; k < n_phi_d_; ++k) {
        const Cell& c = cell(i, j, k);
        const auto [wo, wi] = directions(node(i, j, k));
        if (c[3] == 0 || is_filled(i, j, k) || !(wo.z > 0 && wi.z > 0)) continue;
        s.wo.push_back(Vec3f{float(wo.x), float(wo.y), float(wo.z)});
        s.wi.push_back(Vec3f{float(wi.x), float(wi.y), float(wi.z)});
        s.f.insert(s.f.end(), c.begin(), c.begin() + 3);
        s.weight.push_back(node_weight(i, j));
      }
  return s;
}

MerlTable tabulate_merl(const MeasuredBsdf& measured) {
  if (!measured.sides().reflects_front)
    throw Error("a MERL table holds reflection on the front, and this measurement has none: " +
                measured.kind());
  const int turns = measured.is_isotropic() ? 1 : 16;
  return MerlTable::tabulate(
      MerlTable::original_theta_h, MerlTable::original_theta_d, MerlTable::original_phi_d,
      [&](double theta_h, double theta_d, double phi_d) -> std::array<double, 3> {
        const HalfDifference<double> a{theta_h, theta_d, phi_d};
        if (!above_horizon(a)) return {-1, -1, -1};
        const auto pair = directions(a);
        std::array<double, 3> sum{};
        std::array<float, Channels::max_count> f;
        int found = 0;
        for (int t = 0; t < turns; ++t) {
          const double c = std::cos(2 * pi * t / turns), s = std::sin(2 * pi * t / turns);
          const auto turned = [&](const Vec3d& w) {
            return Vec3d{c * w.x - s * w.y, s * w.x + c * w.y, w.z};
          };
          if (!measured.evaluate(turned(pair.wo), turned(pair.wi),
                                 {f.data(), std::size_t(measured.channels().count())}))
            continue;
          ++found;
          const auto rgb = measured.channels().to_rgb(f);
          for (std::size_t k = 0; k < 3; ++k)
            sum[k] += std::max(rgb[k], 0.0);
        }
        if (found == 0) return {-1, -1, -1};
        return {sum[0] / found, sum[1] / found, sum[2] / found};
      });
}

MerlTable parse_merl(std::span<const std::uint8_t> bytes, std::string_view name) {
  if (bytes.size() < header_bytes)
    throw Error::in_binary(name, bytes.size(),
                           fmt::format("expected a header of {} bytes (three sizes), found {} bytes",
                                       header_bytes, bytes.size()));
  std::array<std::int32_t, 3> n;
  std::memcpy(n.data(), bytes.data(), header_bytes);
  if (const auto [fault, which] = dimension_fault({n[0], n[1], n[2]}); !fault.empty())
    throw Error::in_binary(name, which * sizeof(std::int32_t), fault);
  const std::size_t count = static_cast<std::size_t>(n[0]) * n[1] * n[2];
  const std::size_t expected = header_bytes + count * bytes_per_cell;
  if (bytes.size() != expected)
    throw Error::in_binary(name, std::min(bytes.size(), expected),
                           fmt::format("expected {} bytes for a table of {} x {} x {}, found {}", expected,
                                       n[0], n[1], n[2], bytes.size()));

  const std::uint8_t* plane[3];
  for (int channel = 0; channel < 3; ++channel)
    plane[channel] = bytes.data() + header_bytes + channel * count * sizeof(double);
  const auto stored = [&](int channel, std::size_t c) {
    double x;
    std::memcpy(&x, plane[channel] + c * sizeof(double), sizeof(double));
    return x;
  };
  std::vector<MerlTable::Cell> cells(count);
  std::size_t faulty = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const double r = stored(0, c), g = stored(1, c), b = stored(2, c);
    faulty += !(std::abs(r) < max_stored) + !(std::abs(g) < max_stored) + !(std::abs(b) < max_stored);
    const float measured = r >= 0 && g >= 0 && b >= 0 ? 1.0f : 0.0f;
    cells[c] = measured != 0 ? MerlTable::Cell{static_cast<float>(r * unit_of_channel[0]),
                                               static_cast<float>(g * unit_of_channel[1]),
                                               static_cast<float>(b * unit_of_channel[2]), 1.0f}
                             : MerlTable::Cell{};
  }
  if (faulty > 0)
    for (int channel = 0; channel < 3; ++channel)
      for (std::size_t c = 0; c < count; ++c)
        if (const double x = stored(channel, c); !(std::abs(x) < max_stored))
          throw Error::in_binary(
              name, header_bytes + (channel * count + c) * sizeof(double),
              fmt::format(
                  "{} value{} not a finite number of sensible size, the first {}; expected reflectance, "
                  "negative where not measured",
                  faulty, faulty == 1 ? "" : "s", x));
  return MerlTable(n[0], n[1], n[2], std::move(cells));
}

std::shared_ptr<const MerlTable> read_merl(const std::string& path) {
  std::error_code no_size;
  const auto size = std::filesystem::file_size(path, no_size);
  if (!no_size && size > header_bytes + max_cells * bytes_per_cell)
    throw Error::in_file(
        path, fmt::format("{} bytes, more than the largest table read here ({} entries)", size, max_cells));
  return std::make_shared<const MerlTable>(parse_merl(read_file(path), path));
}

std::vector<std::uint8_t> encode_merl(const MerlTable& table) {
  const std::size_t count = table.size();
  std::vector<std::uint8_t> bytes(header_bytes + count * bytes_per_cell);
  const std::int32_t n[] = {table.n_theta_h(), table.n_theta_d(), table.n_phi_d()};
  std::memcpy(bytes.data(), n, header_bytes);
  std::uint8_t* out = bytes.data() + header_bytes;
  for (int channel = 0; channel < 3; ++channel)
    for (const MerlTable::Cell& cell : table.cells()) {
      const double x = cell[3] != 0 ? cell[channel] / unit_of_channel[channel] : -1.0;
      std::memcpy(out, &x, sizeof x);
      out += sizeof x;
    }
  return bytes;
}

void write_merl(const MerlTable& table, const std::string& path) {
  write_file_atomically(path, encode_merl(table));
}

} // namespace nacre
