#pragma once
// Radiance's tensor tree: a function on the unit cube of 3 or 4 dimensions, constant in cells that halve
// where it varies. Source: Ward, Kurt and Bonneel 2012, A Practical Framework for Sharing and Rendering
// Real-World Bidirectional Scattering Distribution Functions; facts of the text from Radiance's own reader
// and writer.
//
// As text: `{ v }` is one cell, `{ v v ... }` a regular grid of 2^(rank k) cells in which the first dimension
// is the slowest, and `{ {..} {..} ... }` are 2^rank branches, of which branch i has the upper half of
// dimension d where bit d of i is set.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace nacre {

class TensorTree {
public:
  static constexpr int max_depth = 16; ///< halvings
  using Position = std::array<double, 4>;

  /// A single cell.
  TensorTree(int rank, float value);
  /// Negative values become 0, as Radiance reads them.
  /// @param fail  called with the offset into `text` and what is wrong; throws
  static TensorTree parse(int rank, std::string_view text,
                          const std::function<void(std::size_t, const std::string&)>& fail);
  /// Text that `parse` gives the identical tree for; branches on lines of their own.
  std::string to_text() const;

  int rank() const { return rank_; }
  /// Halvings at the smallest cell.
  int depth() const { return depth_; }
  /// Values stored.
  std::size_t cell_count() const { return values_.size(); }
  /// Value of the cell at a position in [0, 1)^rank; clamped into it.
  float at(const Position& position) const;

  /// Calls f(lower corner, side, value) for every cell; one larger than 2^-min_level is cut into cells of
  /// that size, and what lies deeper than max_level is averaged. min_level <= max_level.
  using Visitor = std::function<void(const Position&, double, float)>;
  void visit(int min_level, int max_level, const Visitor& f) const;

  /// Built from the leaves up. Branches hold 2^rank nodes each.
  struct Built {
    float value = 0;
    std::vector<Built> branches; ///< empty: a cell
  };
  TensorTree(int rank, const Built& root);

private:
  struct Node {
    std::int32_t grid_log2;  ///< cells a side of its grid as a power of 2; -1: branches
    std::uint32_t first = 0; ///< of its values or branches
  };
  explicit TensorTree(int rank) : rank_(rank) {}
  void append(std::size_t node, const Built& built, int level);
  void visit(std::size_t node, const Position& lower, int level, int min_level, int max_level,
             const Visitor& f) const;
  double mean(std::size_t node) const;
  void write(std::size_t node, int indent, std::string& text) const;
  friend class TensorTreeParser;

  int rank_, depth_ = 0;
  std::vector<Node> nodes_;
  std::vector<float> values_;
};

} // namespace nacre
