#include "measured/window_bsdf.h"

#include "core/error.h"
#include "core/warp.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <mutex>

namespace nacre {
namespace {

/// The point of the unit square that square_to_disk maps to a point of the unit disk.
Vec2d disk_to_square(double x, double y) {
  const double r = std::min(std::hypot(x, y), 1.0);
  if (r == 0) return {0.5, 0.5};
  const bool x_major = std::abs(x) > std::abs(y);
  const double major = x_major ? x : y, minor = x_major ? y : x;
  const double a = std::copysign(r, major), b = std::atan(minor / major) * 4 / pi * a;
  return x_major ? Vec2d{(a + 1) / 2, (b + 1) / 2} : Vec2d{(b + 1) / 2, (a + 1) / 2};
}

Vec3d lifted(const Vec2d& disk) {
  return {disk.x, disk.y, std::sqrt(std::max(1 - disk.x * disk.x - disk.y * disk.y, 0.0))};
}

/// Solid angle of a cell of the square, at most 1/2 wide and a power of 2. With a the larger of the cell's
/// two coordinates on [-1, 1] and b the other, r = a and phi = pi/4 b / a: dw = r dr dphi / cos theta = pi/4
/// da db / sqrt(1 - a^2).
double solid_angle_of_cell(double x, double y, double side) {
  const double size = 2 * side;
  const auto nearest = [&](double c) { return std::min(std::abs(2 * c - 1), std::abs(2 * c - 1 + size)); };
  const double p = nearest(x), q = nearest(y), a0 = std::max(p, q), a1 = std::min(a0 + size, 1.0);
  if (std::abs(p - q) > 1e-9) return pi / 4 * size * (std::asin(a1) - std::asin(a0));
  // On the diagonal: twice the triangle in which a is larger.
  const auto integral = [&](double a) { return -std::sqrt(1 - a * a) - a0 * std::asin(a); };
  return pi / 2 * (integral(a1) - integral(a0));
}

int rank_of(const WindowBlock& block) {
  const auto* tree = std::get_if<TensorTree>(&block.front());
  return tree ? tree->rank() : 0;
}

/// D65 as the matrices of spectra/color_space.h have it.
constexpr XYZ white = srgb_to_xyz * RGB{1, 1, 1};

} // namespace

TensorTree::Position tensor_position(int rank, const Vec3d& in, const Vec3d& out) {
  if (rank == 4) {
    const Vec2d i = disk_to_square(in.x, in.y), o = disk_to_square(out.x, out.y);
    return {i.x, i.y, o.x, o.y};
  }
  const double r = std::min(std::hypot(in.x, in.y), 1.0);
  const double c = r > 0 ? in.x / r : 1, s = r > 0 ? in.y / r : 0;
  const Vec2d o = disk_to_square(out.x * c + out.y * s, out.y * c - out.x * s);
  return {std::min(0.5 - 0.5 * r, 0.5 - 1e-9), o.x, o.y, 0};
}

std::pair<Vec3d, Vec3d> tensor_directions(int rank, const TensorTree::Position& p) {
  if (rank == 4)
    return {lifted(square_to_disk(Vec2d{p[0], p[1]})), lifted(square_to_disk(Vec2d{p[2], p[3]}))};
  return {lifted({std::max(1 - 2 * p[0], 0.0), 0}), lifted(square_to_disk(Vec2d{p[1], p[2]}))};
}

std::pair<Vec3d, Vec3d> window_directions(WindowDirection direction, const Vec3d& in, const Vec3d& out) {
  const bool from_front =
      direction == WindowDirection::transmission_back || direction == WindowDirection::reflection_back;
  const bool to_front =
      direction == WindowDirection::transmission_front || direction == WindowDirection::reflection_back;
  return {{out.x, out.y, to_front ? out.z : -out.z}, {-in.x, -in.y, from_front ? in.z : -in.z}};
}

/// Of matrices, for directions wo in a patch: the patches of wi on both sides, by their share of the light.
class WindowBsdf::MatrixSampling {
public:
  explicit MatrixSampling(const WindowBsdf& b) {
    for (int side = 0; side < 2; ++side) {
      const double z = side == 0 ? 1 : -1;
      for (int passes = 0; passes < 2; ++passes) {
        const Lookup l = b.lookup({0, 0, z}, {0, 0, passes ? -z : z});
        if (l.block) tables_[side][passes] = Table(*l.block, l.exchanged);
      }
    }
  }

  double pdf(const WindowBsdf& b, const Vec3d& wo, const Vec3d& wi) const {
    const bool passes = wo.z * wi.z < 0;
    const Lookup l = b.lookup(wo, wi);
    if (!l.block || wi.z == 0) return 0;
    const Table& t = tables_[wo.z < 0][passes];
    const auto [stay, total] = shares(wo);
    const double side = passes ? 1 - stay : stay;
    const int given = t.given->patch(l.exchanged ? l.in : l.out);
    if (!(t.total(given) > 0)) return side * std::abs(wi.z) * inv_pi;
    const int chosen = t.chosen->patch(l.exchanged ? l.out : l.in);
    return side * t.probability(given, chosen) / t.chosen->projected_solid_angle(chosen) * std::abs(wi.z);
  }

  Vec3d sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const {
    const auto [stay, total] = shares(wo);
    const bool passes = u_lobe >= stay;
    const Table& t = tables_[wo.z < 0][passes];
    Vec3d w = square_to_cosine_hemisphere(u);
    const double z_sign = (wo.z > 0) == !passes ? 1 : -1;
    if (!t.given) return {w.x, w.y, z_sign * w.z};
    // wo as its patches are counted: as outgoing by x and y, as incident by -x and -y; wi the other way.
    const double sign = t.exchanged ? -1 : 1;
    const int given = t.given->patch({sign * wo.x, sign * wo.y, std::abs(wo.z)});
    if (t.total(given) > 0) {
      const auto [patch, rest] = t.choose(given, u.x);
      const Vec3d p = t.chosen->direction(patch, {rest, u.y});
      w = {-sign * p.x, -sign * p.y, p.z};
    }
    return {w.x, w.y, z_sign * w.z};
  }

private:
  struct Table {
    std::shared_ptr<const KlemsBasis> given, chosen; ///< bases of wo and wi
    bool exchanged = false;
    std::vector<double> cumulative; ///< [given][chosen + 1]

    Table() = default;
    Table(const WindowBlock& block, bool swapped) : exchanged(swapped) {
      const auto& y = std::get<KlemsMatrix>(block.front());
      given = swapped ? y.incident : y.outgoing;
      chosen = swapped ? y.outgoing : y.incident;
      for (int g = 0; g < given->size(); ++g) {
        double sum = 0;
        cumulative.push_back(0);
        for (int c = 0; c < chosen->size(); ++c) {
          double f = 0;
          for (const WindowData& component : block) {
            const auto& m = std::get<KlemsMatrix>(component);
            f += double(swapped ? m.at(g, c) : m.at(c, g));
          }
          cumulative.push_back(sum += f * chosen->projected_solid_angle(c));
        }
      }
    }
    std::size_t row(int g) const { return std::size_t(g) * std::size_t(chosen->size() + 1); }
    double total(int g) const { return cumulative[row(g) + std::size_t(chosen->size())]; }
    double probability(int g, int c) const {
      const double* at = &cumulative[row(g) + std::size_t(c)];
      return (at[1] - at[0]) / total(g);
    }
    /// A patch, and u's place within its part of [0, 1).
    std::pair<int, double> choose(int g, double u) const {
      const double *begin = &cumulative[row(g)], *end = begin + chosen->size(), x = u * total(g);
      const double* at = std::upper_bound(begin, end, x) - 1; // at[0] <= x < at[1]
      while (at > begin && !(at[1] > at[0]))
        --at; // rounding put x at the end of the last
      return {int(at - begin), std::clamp((x - at[0]) / (at[1] - at[0]), 0.0, 1 - 0x1p-53)};
    }
  };

  /// The share of light that stays on wo's side, and all of it.
  std::pair<double, double> shares(const Vec3d& wo) const {
    std::array<double, 2> total{};
    for (std::size_t passes = 0; passes < 2; ++passes) {
      const Table& t = tables_[wo.z < 0][passes];
      if (!t.given) continue;
      const double sign = t.exchanged ? -1 : 1;
      total[passes] = t.total(t.given->patch({sign * wo.x, sign * wo.y, std::abs(wo.z)}));
    }
    const double sum = total[0] + total[1];
    if (sum > 0) return {total[0] / sum, sum};
    return {tables_[wo.z < 0][0].given ? 1.0 : 0.0, 0};
  }

  std::array<std::array<Table, 2>, 2> tables_; ///< [wo behind][wi on the other side]
};

struct WindowBsdf::LazyMatrixSampling {
  std::once_flag once;
  std::unique_ptr<const MatrixSampling> built;
};

WindowBsdf::WindowBsdf(WindowColor color, Blocks blocks, Facts facts)
    : color_(color), blocks_(std::move(blocks)), facts_(std::move(facts)),
      channels_(color == WindowColor::grey ? Channels::grey() : Channels::rgb()),
      sampling_(std::make_unique<LazyMatrixSampling>()) {
  const std::size_t components = color == WindowColor::grey ? 1 : 3;
  int rank = -1;
  for (const auto& block : blocks_) {
    if (!block) continue;
    if (block->size() != components)
      throw Error(
          fmt::format("{} components in a block of scattering, expected {}", block->size(), components));
    for (const WindowData& data : *block) {
      const auto* tree = std::get_if<TensorTree>(&data);
      const int r = tree ? tree->rank() : 0;
      if (rank >= 0 && r != rank) throw Error("blocks of scattering in bases of different kinds");
      rank = r;
      if (tree) continue;
      const auto &m = std::get<KlemsMatrix>(data), &first = std::get<KlemsMatrix>(block->front());
      if (m.incident->size() != first.incident->size() || m.outgoing->size() != first.outgoing->size() ||
          m.values.size() != std::size_t(m.incident->size()) * std::size_t(m.outgoing->size()))
        throw Error("components of a block of scattering in different bases");
    }
  }
  if (rank < 0) throw Error("scattering without any block");
  if (rank == 0 && color == WindowColor::yuv) throw Error("matrices with u' and v', expected X and Z");
  matrices_ = rank == 0;
  isotropic_ = rank == 3;
}

WindowBsdf::WindowBsdf(WindowBsdf&&) noexcept = default;
WindowBsdf& WindowBsdf::operator=(WindowBsdf&&) noexcept = default;
WindowBsdf::~WindowBsdf() = default;

std::string WindowBsdf::kind() const {
  return matrices_ ? "scattering matrices (WINDOW, Klems bases)"
                   : fmt::format("{} tensor tree (Radiance)", isotropic_ ? "isotropic" : "anisotropic");
}

std::vector<std::pair<std::string, std::string>> WindowBsdf::facts() const {
  Facts all = facts_;
  for (std::size_t d = 0; d < blocks_.size(); ++d) {
    if (!blocks_[d]) continue;
    const WindowData& y = blocks_[d]->front();
    if (const auto* m = std::get_if<KlemsMatrix>(&y))
      all.emplace_back(window_direction_names[d],
                       fmt::format("{} incident patches ({}) x {} outgoing ({})", m->incident->size(),
                                   m->incident->name(), m->outgoing->size(), m->outgoing->name()));
    else if (const auto* t = std::get_if<TensorTree>(&y))
      all.emplace_back(window_direction_names[d],
                       fmt::format("rank {}, {} cells, the smallest 1/{} of the square", t->rank(),
                                   t->cell_count(), 1 << t->depth()));
  }
  all.emplace_back("sides", "WINDOW's back (the room) is z > 0");
  return all;
}

MeasuredSides WindowBsdf::sides() const {
  const auto has = [&](WindowDirection d) { return blocks_[std::size_t(d)].has_value(); };
  MeasuredSides s;
  s.reflects_front = has(WindowDirection::reflection_back);
  s.reflects_back = has(WindowDirection::reflection_front);
  s.transmits_to_front = s.transmits_to_back =
      has(WindowDirection::transmission_front) || has(WindowDirection::transmission_back);
  return s;
}

WindowBsdf::Lookup WindowBsdf::lookup(const Vec3d& wo, const Vec3d& wi) const {
  const auto block = [&](WindowDirection d) {
    const auto& b = blocks_[std::size_t(d)];
    return b ? &*b : nullptr;
  };
  if (wo.z == 0 || wi.z == 0) return {};
  Lookup l;
  Vec3d in = wi, out = wo;
  if ((wo.z > 0) == (wi.z > 0)) {
    l.block = block(wo.z > 0 ? WindowDirection::reflection_back : WindowDirection::reflection_front);
  } else {
    const auto from_front = WindowDirection::transmission_back,
               from_back = WindowDirection::transmission_front;
    l.block = block(wi.z > 0 ? from_front : from_back);
    if (!l.block) {
      l.block = block(wi.z > 0 ? from_back : from_front);
      l.exchanged = true;
      std::swap(in, out);
    }
  }
  l.in = {-in.x, -in.y, std::abs(in.z)};
  l.out = {out.x, out.y, std::abs(out.z)};
  return l;
}

void WindowBsdf::to_channels(std::array<float, 3> stored, float* f) const {
  if (color_ == WindowColor::grey) {
    f[0] = stored[0];
    return;
  }
  XYZ xyz{double(stored[0]), double(stored[1]), double(stored[2])};
  if (color_ == WindowColor::yuv) {
    // CIE 15: u' = 4 X / (X + 15 Y + 3 Z), v' = 9 Y / (X + 15 Y + 3 Z).
    // No light has u' above 1 or v' near 0 (CIE 1931: v' > 0.01).
    const double y = double(stored[0]), u = std::min(double(stored[1]), 1.0),
                 v = std::min(double(stored[2]), 1.0);
    xyz = v > 1e-3 ? XYZ{y * 9 * u / (4 * v), y, std::max(y * (12 - 3 * u - 20 * v) / (4 * v), 0.0)}
                   : XYZ{y, y, y};
  }
  const RGB rgb = xyz_to_srgb * XYZ{xyz[0] * white[0], xyz[1] * white[1], xyz[2] * white[2]};
  for (std::size_t c = 0; c < 3; ++c)
    f[c] = float(rgb[c]);
}

bool WindowBsdf::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  std::fill_n(f.begin(), channels_.count(), 0.0f);
  const Lookup l = lookup(wo, wi);
  if (!l.block) return false;
  std::array<float, 3> stored{};
  if (matrices_) {
    const auto& y = std::get<KlemsMatrix>(l.block->front());
    const int in = y.incident->patch(l.in), out = y.outgoing->patch(l.out);
    for (std::size_t c = 0; c < l.block->size(); ++c)
      stored[c] = std::get<KlemsMatrix>((*l.block)[c]).at(in, out);
  } else {
    const auto position = tensor_position(rank_of(*l.block), l.in, l.out);
    for (std::size_t c = 0; c < l.block->size(); ++c)
      stored[c] = std::get<TensorTree>((*l.block)[c]).at(position);
  }
  to_channels(stored, f.data());
  return true;
}

void WindowBsdf::append_samples(MeasuredSamples& s, WindowDirection direction,
                                const WindowBlock& block) const {
  const auto push = [&](const Vec3d& in, const Vec3d& out, double weight, std::array<float, 3> stored) {
    const auto [wo, wi] = window_directions(direction, in, out);
    s.wo.push_back({float(wo.x), float(wo.y), float(wo.z)});
    s.wi.push_back({float(wi.x), float(wi.y), float(wi.z)});
    std::array<float, 3> f{};
    to_channels(stored, f.data());
    s.f.insert(s.f.end(), f.begin(), f.begin() + channels_.count());
    s.weight.push_back(weight);
  };
  if (const auto* y = std::get_if<KlemsMatrix>(&block.front())) {
    for (int out = 0; out < y->outgoing->size(); ++out)
      for (int in = 0; in < y->incident->size(); ++in) {
        std::array<float, 3> stored{};
        for (std::size_t c = 0; c < block.size(); ++c)
          stored[c] = std::get<KlemsMatrix>(block[c]).at(in, out);
        // The first patch is a cap about the pole, whose middle is the pole.
        const auto middle = [](const KlemsBasis& basis, int patch) {
          return patch == 0 && basis.rings()[0].sectors == 1 ? Vec3d{0, 0, 1}
                                                             : basis.direction(patch, {0.5, 0.5});
        };
        push(middle(*y->incident, in), middle(*y->outgoing, out),
             y->incident->solid_angle(in) * y->outgoing->solid_angle(out), stored);
      }
    return;
  }
  const auto& y = std::get<TensorTree>(block.front());
  const int rank = y.rank();
  int level = std::min(y.depth(), 20 / rank);
  for (; level < y.depth(); ++level) {
    std::size_t cells = 0;
    y.visit(0, level + 1, [&](const auto&, double, float) { ++cells; });
    if (cells > std::size_t(1) << 20) break;
  }
  level = std::max(level, 3);
  y.visit(3, level, [&](const TensorTree::Position& lower, double side, float value) {
    TensorTree::Position middle = lower;
    for (int d = 0; d < rank; ++d)
      middle[std::size_t(d)] += side / 2;
    if (rank == 3 && middle[0] >= 0.5) return; // holds nothing
    const auto [in, out] = tensor_directions(rank, middle);
    const auto cosine = [](double r) { return std::sqrt(std::max(1 - r * r, 0.0)); };
    const double weight_in = rank == 4
                                 ? solid_angle_of_cell(lower[0], lower[1], side)
                                 : 2 * pi * (cosine(1 - 2 * (lower[0] + side)) - cosine(1 - 2 * lower[0]));
    const std::size_t o = rank == 4 ? 2 : 1;
    const double weight = weight_in * solid_angle_of_cell(lower[o], lower[o + 1], side);
    std::array<float, 3> stored{value, 0, 0};
    for (std::size_t c = 1; c < block.size(); ++c)
      stored[c] = std::get<TensorTree>(block[c]).at(middle);
    push(in, out, weight, stored);
  });
}

MeasuredSamples WindowBsdf::samples() const {
  MeasuredSamples s;
  for (std::size_t d = 0; d < blocks_.size(); ++d)
    if (blocks_[d]) append_samples(s, WindowDirection(d), *blocks_[d]);
  return s;
}

const WindowBsdf::MatrixSampling& WindowBsdf::matrix_sampling() const {
  std::call_once(sampling_->once, [&] { sampling_->built = std::make_unique<MatrixSampling>(*this); });
  return *sampling_->built;
}

double WindowBsdf::pdf(const Vec3d& wo, const Vec3d& wi) const {
  return matrices_ ? matrix_sampling().pdf(*this, wo, wi) : MeasuredBsdf::pdf(wo, wi);
}

Vec3d WindowBsdf::sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const {
  return matrices_ ? matrix_sampling().sample(wo, u_lobe, u) : MeasuredBsdf::sample(wo, u_lobe, u);
}

} // namespace nacre
