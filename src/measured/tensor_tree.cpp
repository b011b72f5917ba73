#include "measured/tensor_tree.h"

#include "core/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace nacre {

class TensorTreeParser {
public:
  using Fail = std::function<void(std::size_t, const std::string&)>;
  TensorTreeParser(std::string_view text, const Fail& fail, TensorTree& tree)
      : text_(text), fail_(fail), tree_(tree) {}

  void all() {
    tree_.nodes_.push_back({});
    node(0, 0);
    skip();
    if (at_ < text_.size()) fail("expected the end of the tree");
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    fail_(at_, what);
    throw Error(what);
  }
  /// To the next character that is neither blank nor comma.
  char skip() {
    constexpr std::string_view blanks = " \t\r\n,";
    while (at_ < text_.size() && blanks.find(text_[at_]) != std::string_view::npos)
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  void expect(char c) {
    if (const char found = skip(); found != c)
      fail(fmt::format("expected '{}' in a tensor tree, found {}", c,
                       at_ < text_.size() ? fmt::format("'{}'", found) : "its end"));
    ++at_;
  }

  void node(std::size_t index, int level) {
    if (level > TensorTree::max_depth)
      fail(fmt::format("a tensor tree deeper than {} levels", TensorTree::max_depth));
    expect('{');
    const std::size_t branches = std::size_t(1) << tree_.rank_;
    if (skip() == '{') {
      const std::size_t first = tree_.nodes_.size();
      tree_.nodes_.resize(first + branches);
      tree_.nodes_[index] = {-1, std::uint32_t(first)};
      for (std::size_t b = 0; b < branches; ++b)
        node(first + b, level + 1);
    } else {
      const std::size_t begin = at_, first = tree_.values_.size();
      while (skip() != '}')
        tree_.values_.push_back(value());
      const std::size_t count = tree_.values_.size() - first;
      int log2 = 0;
      while (log2 < TensorTree::max_depth && count > std::size_t(1) << (tree_.rank_ * log2) &&
             tree_.rank_ * log2 < 40)
        ++log2;
      if (count != std::size_t(1) << (tree_.rank_ * log2)) {
        at_ = begin;
        fail(fmt::format("{} values in a cell of a tensor tree of rank {}, expected a power of {}", count,
                         tree_.rank_, branches));
      }
      if (level + log2 > TensorTree::max_depth)
        fail(fmt::format("a tensor tree deeper than {} levels", TensorTree::max_depth));
      tree_.nodes_[index] = {log2, std::uint32_t(first)};
      tree_.depth_ = std::max(tree_.depth_, level + log2);
    }
    expect('}');
  }

  float value() {
    double x = 0;
    const char *begin = text_.data() + at_, *end = text_.data() + text_.size();
    if (begin < end && *begin == '+') ++begin;
    const auto [after, error] = std::from_chars(begin, end, x);
    if (error == std::errc::result_out_of_range && std::abs(x) < 1)
      x = 0;
    else if (error != std::errc() || !(std::abs(x) < 1e30))
      fail("expected a finite number in a tensor tree");
    at_ = std::size_t(after - text_.data());
    return float(std::max(x, 0.0));
  }

  std::string_view text_;
  const Fail& fail_;
  TensorTree& tree_;
  std::size_t at_ = 0;
};

TensorTree::TensorTree(int rank, float value) : rank_(rank), nodes_{{0, 0}}, values_{value} {}

TensorTree::TensorTree(int rank, const Built& root) : rank_(rank) {
  nodes_.push_back({});
  append(0, root, 0);
}

void TensorTree::append(std::size_t node, const Built& built, int level) {
  if (built.branches.empty()) {
    nodes_[node] = {0, std::uint32_t(values_.size())};
    values_.push_back(built.value);
    depth_ = std::max(depth_, level);
    return;
  }
  const std::size_t first = nodes_.size();
  nodes_.resize(first + built.branches.size());
  nodes_[node] = {-1, std::uint32_t(first)};
  for (std::size_t b = 0; b < built.branches.size(); ++b)
    append(first + b, built.branches[b], level + 1);
}

TensorTree TensorTree::parse(int rank, std::string_view text, const TensorTreeParser::Fail& fail) {
  TensorTree tree(rank);
  TensorTreeParser(text, fail, tree).all();
  return tree;
}

float TensorTree::at(const Position& position) const {
  Position p;
  for (int d = 0; d < rank_; ++d) // also a NaN to 0
    p[std::size_t(d)] = position[std::size_t(d)] > 0 ? std::min(position[std::size_t(d)], 1 - 0x1p-30) : 0;
  const Node* node = nodes_.data();
  while (node->grid_log2 < 0) {
    std::size_t branch = 0;
    for (int d = 0; d < rank_; ++d) {
      double& x = p[std::size_t(d)];
      x *= 2;
      if (x >= 1) {
        x -= 1;
        branch |= std::size_t(1) << d;
      }
    }
    node = &nodes_[node->first + branch];
  }
  std::size_t index = 0;
  for (int d = 0; d < rank_; ++d)
    index = (index << node->grid_log2) + std::size_t(std::ldexp(p[std::size_t(d)], node->grid_log2));
  return values_[node->first + index];
}

double TensorTree::mean(std::size_t node) const {
  const Node& n = nodes_[node];
  const std::size_t count = std::size_t(1) << (rank_ * std::max(n.grid_log2, 1));
  double sum = 0;
  if (n.grid_log2 < 0) {
    for (std::size_t b = 0; b < count; ++b)
      sum += mean(n.first + b);
    return sum / double(count);
  }
  const std::size_t cells = std::size_t(1) << (rank_ * n.grid_log2);
  for (std::size_t c = 0; c < cells; ++c)
    sum += double(values_[n.first + c]);
  return sum / double(cells);
}

void TensorTree::visit(int min_level, int max_level, const Visitor& f) const {
  visit(0, {}, 0, min_level, max_level, f);
}

void TensorTree::visit(std::size_t node, const Position& lower, int level, int min_level, int max_level,
                       const Visitor& f) const {
  const Node& n = nodes_[node];
  const double side = std::ldexp(1.0, -level);
  if (n.grid_log2 < 0) {
    if (level >= max_level) return f(lower, side, float(mean(node)));
    for (std::size_t b = 0; b < std::size_t(1) << rank_; ++b) {
      Position corner = lower;
      for (int d = 0; d < rank_; ++d)
        if (b >> d & 1) corner[std::size_t(d)] += side / 2;
      visit(n.first + b, corner, level + 1, min_level, max_level, f);
    }
    return;
  }
  // A grid of 2^used cells a side, each the mean of 2^(grid - used) a side, or a copy where used > grid.
  const int used = std::clamp(n.grid_log2, std::max(min_level - level, 0), std::max(max_level - level, 0));
  const double cell = std::ldexp(side, -used);
  const std::size_t per_side = std::size_t(1) << used;
  for (std::size_t c = 0; c < std::size_t(1) << (rank_ * used); ++c) {
    std::array<std::size_t, 4> at{};
    std::size_t rest = c;
    for (int d = rank_ - 1; d >= 0; --d, rest /= per_side)
      at[std::size_t(d)] = rest % per_side;
    Position corner = lower;
    for (int d = 0; d < rank_; ++d)
      corner[std::size_t(d)] += double(at[std::size_t(d)]) * cell;
    const int finer = std::max(n.grid_log2 - used, 0), coarser = std::max(used - n.grid_log2, 0);
    double sum = 0;
    const std::size_t inside = std::size_t(1) << (rank_ * finer);
    for (std::size_t s = 0; s < inside; ++s) {
      std::size_t index = 0, part = s;
      for (int d = 0; d < rank_; ++d) {
        index = (index << n.grid_log2) +
                (((at[std::size_t(d)] >> coarser) << finer) + (part & ((std::size_t(1) << finer) - 1)));
        part >>= finer;
      }
      sum += double(values_[n.first + index]);
    }
    f(corner, cell, float(sum / double(inside)));
  }
}

void TensorTree::write(std::size_t node, int indent, std::string& text) const {
  const Node& n = nodes_[node];
  text.append(std::size_t(indent), ' ');
  text += '{';
  if (n.grid_log2 >= 0) {
    for (std::size_t c = 0; c < std::size_t(1) << (rank_ * n.grid_log2); ++c)
      fmt::format_to(std::back_inserter(text), " {}", values_[n.first + c]);
    text += " }\n";
    return;
  }
  text += '\n';
  for (std::size_t b = 0; b < std::size_t(1) << rank_; ++b)
    write(n.first + b, indent + 1, text);
  text.append(std::size_t(indent), ' ');
  text += "}\n";
}

std::string TensorTree::to_text() const {
  std::string text;
  write(0, 0, text);
  return text;
}

} // namespace nacre
