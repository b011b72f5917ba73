#pragma once
// The nearest points to a position: a kd-tree over points of few dimensions.

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace nacre {

template <int D>
class PointTree {
public:
  using Point = std::array<float, D>;
  struct Near {
    double squared; ///< distance
    std::uint32_t point;
    bool operator<(const Near& o) const {
      return squared != o.squared ? squared < o.squared : point < o.point;
    }
  };

  /// Finite coordinates, at most 2^32 - 1 points.
  explicit PointTree(std::vector<Point> points) : points_(std::move(points)), order_(points_.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    axes_.resize(points_.size());
    build(0, order_.size());
  }
  std::size_t size() const { return points_.size(); }

  /// The `count` points nearest to `p`, fewer where there are fewer, nearest first.
  void nearest(const Point& p, std::size_t count, std::vector<Near>& found) const {
    found.clear();
    search(p, count, found, 0, order_.size());
    std::sort_heap(found.begin(), found.end());
  }

private:
  static constexpr std::size_t leaf_size = 8;

  /// Middle element of each range splits it along the axis of largest extent.
  void build(std::size_t from, std::size_t to) {
    if (to - from <= leaf_size) return;
    Point low = points_[order_[from]], high = low;
    for (std::size_t i = from; i < to; ++i)
      for (int d = 0; d < D; ++d) {
        low[d] = std::min(low[d], points_[order_[i]][d]);
        high[d] = std::max(high[d], points_[order_[i]][d]);
      }
    std::uint8_t axis = 0;
    for (int d = 1; d < D; ++d)
      if (high[d] - low[d] > high[axis] - low[axis]) axis = std::uint8_t(d);
    const std::size_t middle = from + (to - from) / 2;
    std::nth_element(order_.begin() + from, order_.begin() + middle, order_.begin() + to,
                     [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    axes_[middle] = axis;
    build(from, middle);
    build(middle + 1, to);
  }

  void offer(const Point& p, std::size_t count, std::vector<Near>& found, std::uint32_t point) const {
    double squared = 0;
    for (int d = 0; d < D; ++d) {
      const double x = double(points_[point][d]) - double(p[d]);
      squared += x * x;
    }
    const Near candidate{squared, point};
    if (found.size() < count) {
      found.push_back(candidate);
      std::push_heap(found.begin(), found.end());
    } else if (candidate < found.front()) {
      std::pop_heap(found.begin(), found.end());
      found.back() = candidate;
      std::push_heap(found.begin(), found.end());
    }
  }

  void search(const Point& p, std::size_t count, std::vector<Near>& found, std::size_t from,
              std::size_t to) const {
    if (to - from <= leaf_size) {
      for (std::size_t i = from; i < to; ++i)
        offer(p, count, found, order_[i]);
      return;
    }
    const std::size_t middle = from + (to - from) / 2;
    const int axis = axes_[middle];
    offer(p, count, found, order_[middle]);
    const double off = double(p[axis]) - double(points_[order_[middle]][axis]);
    const bool below = off < 0;
    below ? search(p, count, found, from, middle) : search(p, count, found, middle + 1, to);
    if (found.size() < count || off * off <= found.front().squared)
      below ? search(p, count, found, middle + 1, to) : search(p, count, found, from, middle);
  }

  std::vector<Point> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axes_;
};

} // namespace nacre
