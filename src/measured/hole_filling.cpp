#include "measured/hole_filling.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>

namespace nacre {
namespace {

enum class Entry : std::uint8_t { known, wanted, outside };

/// The table's grid as seen by the filling: what is known of each entry, and who is next to whom.
struct Grid {
  std::array<int, 3> n;
  std::vector<Entry> entries;

  explicit Grid(const MerlTable& table)
      : n{table.n_theta_h(), table.n_theta_d(), table.n_phi_d()}, entries(table.size()) {
    std::size_t at = 0;
    for (int i = 0; i < n[0]; ++i)
      for (int j = 0; j < n[1]; ++j)
        for (int k = 0; k < n[2]; ++k, ++at)
          entries[at] = !table.is_hole(i, j, k)              ? Entry::known
                        : above_horizon(table.node(i, j, k)) ? Entry::wanted
                                                             : Entry::outside;
  }
  std::size_t index(int i, int j, int k) const {
    return (std::size_t(i) * std::size_t(n[1]) + std::size_t(j)) * std::size_t(n[2]) + std::size_t(k);
  }
  /// The next entry along an axis, round the circle in phi_d; `none` at the ends of the others.
  static constexpr std::size_t none = std::size_t(-1);
  std::size_t next(int i, int j, int k, int axis) const {
    std::array<int, 3> at{i, j, k};
    int& x = at[std::size_t(axis)];
    if (++x == n[std::size_t(axis)]) {
      if (axis != 2 || n[2] < 3) return none;
      x = 0;
    }
    return index(at[0], at[1], at[2]);
  }
  template <class F>
  void for_each(F f) const {
    std::size_t at = 0;
    for (int i = 0; i < n[0]; ++i)
      for (int j = 0; j < n[1]; ++j)
        for (int k = 0; k < n[2]; ++k, ++at)
          f(i, j, k, at);
  }
};

/// Straight lines between the entries of `x` that are known, the nearest beyond them.
void bridge(std::vector<double>& x, const std::vector<double>& count) {
  int before = -1;
  const int n = int(x.size());
  for (int i = 0; i < n; ++i) {
    if (!(count[std::size_t(i)] > 0)) continue;
    for (int gap = before + 1; gap < i; ++gap) {
      const double t = before < 0 ? 1 : double(gap - before) / (i - before);
      x[std::size_t(gap)] = (before < 0 ? 0 : (1 - t) * x[std::size_t(before)]) + t * x[std::size_t(i)];
    }
    before = i;
  }
  for (int gap = before + 1; gap < n; ++gap)
    x[std::size_t(gap)] = x[std::size_t(before)];
}

/// log f = over_h[i] + over_d[j] + remainder: the first two by alternating means over what is known.
class Product {
public:
  Product(const Grid& grid, const std::vector<double>& log_f)
      : over_h_(std::size_t(grid.n[0])), over_d_(std::size_t(grid.n[1])) {
    const std::size_t n_h = over_h_.size(), n_d = over_d_.size();
    std::vector<double> sum(n_h * n_d), count(n_h * n_d), count_h(n_h), count_d(n_d);
    grid.for_each([&](int i, int j, int, std::size_t at) {
      if (grid.entries[at] != Entry::known) return;
      const std::size_t cell = std::size_t(i) * n_d + std::size_t(j);
      sum[cell] += log_f[at], count[cell] += 1;
      count_h[std::size_t(i)] += 1, count_d[std::size_t(j)] += 1;
    });
    // Each round comes nearer by a factor that depends on the pattern of holes.
    for (int round = 0; round < 400; ++round) {
      double change = 0;
      for (std::size_t i = 0; i < n_h; ++i) {
        if (!(count_h[i] > 0)) continue;
        double total = 0;
        for (std::size_t j = 0; j < n_d; ++j)
          total += sum[i * n_d + j] - count[i * n_d + j] * over_d_[j];
        change = std::max(change, std::abs(total / count_h[i] - over_h_[i]));
        over_h_[i] = total / count_h[i];
      }
      for (std::size_t j = 0; j < n_d; ++j) {
        if (!(count_d[j] > 0)) continue;
        double total = 0;
        for (std::size_t i = 0; i < n_h; ++i)
          total += sum[i * n_d + j] - count[i * n_d + j] * over_h_[i];
        over_d_[j] = total / count_d[j];
      }
      if (change < 1e-9) break;
    }
    bridge(over_h_, count_h);
    bridge(over_d_, count_d);
  }
  double operator()(int i, int j) const { return over_h_[std::size_t(i)] + over_d_[std::size_t(j)]; }

private:
  std::vector<double> over_h_, over_d_;
};

/// A weight an axis: the inverse mean square of differences between known neighbours, within 1 to 10^4 of
/// each other.
std::array<double, 3> axis_weights(const Grid& grid, const std::vector<double>& remainder) {
  std::array<double, 3> square{}, count{}, weight{};
  grid.for_each([&](int i, int j, int k, std::size_t at) {
    if (grid.entries[at] != Entry::known) return;
    for (int axis = 0; axis < 3; ++axis)
      if (const std::size_t q = grid.next(i, j, k, axis);
          q != Grid::none && grid.entries[q] == Entry::known) {
        square[std::size_t(axis)] += sqr(remainder[q] - remainder[at]);
        count[std::size_t(axis)] += 1;
      }
  });
  double largest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (count[a] > 0) largest = std::max(largest, square[a] / count[a]);
  for (std::size_t a = 0; a < 3; ++a)
    weight[a] = count[a] > 0 && largest > 0 ? largest / std::max(square[a] / count[a], 1e-4 * largest) : 1;
  return weight;
}

/// Symmetric equations of a membrane: a diagonal, and -weight of its axis for each pair of neighbours.
class MembraneEquations {
public:
  explicit MembraneEquations(const std::array<double, 3>& weight, std::size_t size)
      : weight_(weight), diagonal_(size) {}
  void add_to_diagonal(std::int32_t p, int axis) { diagonal_[std::size_t(p)] += weight_[std::size_t(axis)]; }
  void link(std::int32_t p, std::int32_t q, int axis) { links_.push_back({p, q, axis}); }

  /// By conjugate gradients from 0, with the diagonal as preconditioner. An entry out of reach of all that is
  /// known keeps the 0: the product alone.
  std::vector<double> solve(std::vector<double> residual) const {
    std::vector<double> x(residual.size()), z(x.size()), direction, image(x.size());
    const auto precondition = [&] {
      for (std::size_t m = 0; m < z.size(); ++m)
        z[m] = diagonal_[m] > 0 ? residual[m] / diagonal_[m] : 0;
    };
    precondition();
    direction = z;
    double energy = dot(residual, z);
    const double goal = 1e-12 * energy;
    for (int step = 0; step < 2000 && energy > goal; ++step) {
      multiply(direction, image);
      const double along = dot(direction, image);
      if (!(along > 0)) break;
      const double length = energy / along;
      for (std::size_t m = 0; m < x.size(); ++m) {
        x[m] += length * direction[m];
        residual[m] -= length * image[m];
      }
      precondition();
      const double next = dot(residual, z);
      for (std::size_t m = 0; m < x.size(); ++m)
        direction[m] = z[m] + next / energy * direction[m];
      energy = next;
    }
    return x;
  }

private:
  struct Link {
    std::int32_t p, q;
    int axis;
  };

  void multiply(const std::vector<double>& x, std::vector<double>& y) const {
    for (std::size_t m = 0; m < x.size(); ++m)
      y[m] = diagonal_[m] * x[m];
    for (const Link& link : links_) {
      const double w = weight_[std::size_t(link.axis)];
      y[std::size_t(link.p)] -= w * x[std::size_t(link.q)];
      y[std::size_t(link.q)] -= w * x[std::size_t(link.p)];
    }
  }
  static double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t m = 0; m < a.size(); ++m)
      sum += a[m] * b[m];
    return sum;
  }

  std::array<double, 3> weight_;
  std::vector<double> diagonal_;
  std::vector<Link> links_;
};

/// Sets the remainder of the wanted entries to the membrane through the known ones.
void stretch_membrane(const Grid& grid, const std::array<double, 3>& weight, std::vector<double>& remainder) {
  std::vector<std::int32_t> place(grid.entries.size(), -1);
  std::vector<std::size_t> wanted;
  for (std::size_t at = 0; at < place.size(); ++at)
    if (grid.entries[at] == Entry::wanted) {
      place[at] = std::int32_t(wanted.size());
      wanted.push_back(at);
    }
  MembraneEquations equations(weight, wanted.size());
  std::vector<double> right(wanted.size());
  const auto touch = [&](std::size_t p, std::size_t q, int axis) {
    if (place[p] < 0 || grid.entries[q] == Entry::outside) return;
    equations.add_to_diagonal(place[p], axis);
    if (place[q] < 0) right[std::size_t(place[p])] += weight[std::size_t(axis)] * remainder[q];
  };
  grid.for_each([&](int i, int j, int k, std::size_t at) {
    for (int axis = 0; axis < 3; ++axis)
      if (const std::size_t q = grid.next(i, j, k, axis); q != Grid::none) {
        touch(at, q, axis);
        touch(q, at, axis);
        if (place[at] >= 0 && place[q] >= 0) equations.link(place[at], place[q], axis);
      }
  });
  const std::vector<double> x = equations.solve(std::move(right));
  for (std::size_t m = 0; m < wanted.size(); ++m)
    remainder[wanted[m]] = x[m];
}

/// One channel of the wanted cells, from the known ones.
void extrapolate(const Grid& grid, std::vector<MerlTable::Cell>& cells, std::size_t channel) {
  double sum = 0, known = 0;
  for (std::size_t at = 0; at < cells.size(); ++at)
    if (grid.entries[at] == Entry::known) sum += double(cells[at][channel]), known += 1;
  if (!(sum > 0)) return; // black: so are the holes
  const double least = 1e-6 * sum / known;
  std::vector<double> remainder(cells.size());
  for (std::size_t at = 0; at < cells.size(); ++at)
    if (grid.entries[at] == Entry::known)
      remainder[at] = std::log(std::max(double(cells[at][channel]), least));
  const Product product(grid, remainder);
  grid.for_each([&](int i, int j, int, std::size_t at) {
    if (grid.entries[at] == Entry::known) remainder[at] -= product(i, j);
  });
  stretch_membrane(grid, axis_weights(grid, remainder), remainder);
  constexpr double largest = 1e30; // what a table's file may hold, and more than any reflectance
  grid.for_each([&](int i, int j, int, std::size_t at) {
    if (grid.entries[at] == Entry::wanted)
      cells[at][channel] = float(std::min(std::exp(product(i, j) + remainder[at]), largest));
  });
}

} // namespace

FilledTable fill_holes(const MerlTable& table) {
  if (table.hole_count() == table.size())
    throw Error("a table without a measured entry has nothing to fill its holes from");
  Grid grid(table);
  std::vector<MerlTable::Cell> cells(table.cells().begin(), table.cells().end());
  std::vector<bool> filled(cells.size());
  grid.for_each([&](int i, int j, int k, std::size_t at) { filled[at] = table.is_filled(i, j, k); });

  // Wanted entries whose partner in phi_d is known.
  const auto fill_from = [&](auto partner) {
    std::vector<std::size_t> found;
    grid.for_each([&](int i, int j, int k, std::size_t at) {
      if (grid.entries[at] != Entry::wanted) return;
      const std::size_t from = grid.index(i, j, partner(k));
      if (grid.entries[from] != Entry::known) return;
      cells[at] = cells[from];
      found.push_back(at);
    });
    for (const std::size_t at : found)
      grid.entries[at] = Entry::known, filled[at] = true;
    return found.size();
  };
  const int n = table.n_phi_d();
  std::size_t by_reciprocity = 0, by_extrapolation = 0;
  if (table.phi_d_period() > 4) by_reciprocity = fill_from([&](int k) { return (k + n / 2) % n; });
  const std::size_t by_mirror_image = fill_from([&](int k) { return (n - k) % n; });

  for (std::size_t channel = 0; channel < 3; ++channel)
    extrapolate(grid, cells, channel);
  for (std::size_t at = 0; at < cells.size(); ++at)
    if (grid.entries[at] == Entry::wanted) {
      cells[at][3] = 1;
      filled[at] = true;
      ++by_extrapolation;
    }
  return {MerlTable(table.n_theta_h(), table.n_theta_d(), n, std::move(cells), std::move(filled)),
          by_reciprocity, by_mirror_image, by_extrapolation};
}

} // namespace nacre
