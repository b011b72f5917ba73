#include "fit/screening.h"

#include "core/pack.h"
#include "core/parallel.h"
#include "core/sobol.h"
#include "fit/channel_lobe.h"

#include <Eigen/Dense>
#include <map>
#include <numeric>

namespace nacre {
namespace {

std::size_t padded(std::size_t n) { return (n + pack_width - 1) / pack_width * pack_width; }

/// min of v.A.v / 2 - b.v inside bounds, a coordinate at a time: A is small and positive.
void solve_in_box(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& lo,
                  const Eigen::VectorXd& hi, Eigen::VectorXd& v) {
  const Eigen::VectorXd free = A.ldlt().solve(b);
  if (free.allFinite() && (free.array() >= lo.array()).all() && (free.array() <= hi.array()).all()) {
    v = free;
    return;
  }
  for (int sweep = 0; sweep < 60; ++sweep) {
    double moved = 0;
    for (Eigen::Index k = 0; k < v.size(); ++k) {
      if (!(A(k, k) > 0)) continue;
      const double next = std::clamp(v[k] + (b[k] - A.row(k).dot(v)) / A(k, k), lo[k], hi[k]);
      moved += std::abs(next - v[k]) * std::sqrt(A(k, k));
      v[k] = next;
    }
    if (moved < 1e-9 * std::sqrt(std::abs(b.dot(v)) + 1e-300)) break;
  }
}

} // namespace

Screening::Screening(const Residuals& residuals)
    : residuals_(residuals), layout_(residuals.layout()), is_linear_(std::size_t(layout_.size()), false) {
  find_linear();
  for (int i = 0; i < layout_.size(); ++i) {
    const FreeParameter& p = layout_[i];
    const ModelInfo& model = model_info(layout_.start().lobes[std::size_t(p.lobe)]);
    is_searched_.push_back(!is_linear_[std::size_t(i)] && model.parameters[std::size_t(p.parameter)].fitted);
  }
}

/// A parameter joins the affine ones of its lobe if neither its own value nor that of one that has joined
/// changes its derivative, at some points of the domain.
void Screening::find_linear() {
  const Observations& at = residuals_.observations();
  const MaterialSpec& start = layout_.start();
  const std::size_t n = padded(std::min<std::size_t>(at.count, 64)), step = at.wo[0].size() / n;
  std::array<std::array<std::vector<float>, 3>, 2> w; // spread over all nodes
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < n; ++i) {
      w[0][k].push_back(at.wo[k][i * step]);
      w[1][k].push_back(at.wi[k][i * step]);
    }
  const DirectionArrays directions{{w[0][0].data(), w[0][1].data(), w[0][2].data()},
                                   {w[1][0].data(), w[1][1].data(), w[1][2].data()}};
  for (std::size_t l = 0; l < start.lobes.size(); ++l) {
    // The channels of a listed model are alike; those of a shader are each its own.
    const std::vector<int> channels =
        start.lobes[l].user ? std::vector<int>(residuals_.channels().begin(), residuals_.channels().end())
                            : std::vector<int>{residuals_.channels().front()};
    std::map<std::pair<int, int>, bool> independent; // slots of a derivative and of a value
    std::vector<int> slots;                          // in the order of the numbers
    for (const int channel : channels) {
      const ChannelLobe function(start.lobes[l], channel);
      std::vector<int> varying, slot;
      for (std::size_t k = 0; k < function.numbers().size(); ++k) {
        const auto [parameter, of] = function.numbers()[k];
        const int i = layout_.index(int(l), parameter, of);
        if (i < 0) continue;
        varying.push_back(int(k));
        slot.push_back(i);
        if (std::find(slots.begin(), slots.end(), i) == slots.end()) slots.push_back(i);
      }
      const std::size_t m = varying.size();
      const auto value_at = [&](std::size_t k, double u) {
        const FreeParameter& p = layout_[slot[k]];
        return p.value(p.coordinate_lo() + u * (p.coordinate_hi() - p.coordinate_lo()));
      };
      std::vector<float> f(n), base(n * m), moved(n * m);
      for (int point = 0; point < 3; ++point) {
        std::vector<double> values = function.values();
        SobolSampler sampler(7, l, std::uint32_t(point));
        for (std::size_t k = 0; k < m; ++k)
          values[std::size_t(varying[k])] = value_at(k, 0.2 + 0.6 * double(sampler.next_1d()));
        function.evaluate(values, varying, directions, n, f.data(), base.data());
        for (std::size_t by = 0; by < m; ++by) {
          std::vector<double> other = values;
          const FreeParameter& p = layout_[slot[by]];
          double& v = other[std::size_t(varying[by])];
          v = v - p.lo > p.hi - v ? 0.5 * (p.lo + v) : 0.5 * (v + p.hi);
          function.evaluate(other, varying, directions, n, f.data(), moved.data());
          for (std::size_t of = 0; of < m; ++of) {
            double difference = 0, size = 0;
            for (std::size_t i = of * n; i < (of + 1) * n; ++i) {
              difference += sqr(double(base[i]) - double(moved[i]));
              size += sqr(double(base[i])) + sqr(double(moved[i]));
            }
            auto& is = independent.try_emplace({slot[of], slot[by]}, true).first->second;
            is = is && difference <= 1e-8 * size;
          }
        }
      }
    }
    std::vector<int> joined;
    for (const int slot : slots) {
      bool joins = independent[{slot, slot}] && layout_[slot].tied < 0;
      for (const int other : joined)
        joins = joins && independent[{slot, other}] && independent[{other, slot}];
      if (!joins) continue;
      joined.push_back(slot);
      const FreeParameter& p = layout_[slot];
      if (start.lobes[l].user)
        is_linear_[std::size_t(slot)] = true;
      else
        for (const int c : residuals_.channels())
          is_linear_[std::size_t(layout_.index(int(l), p.parameter, c))] = true;
    }
  }
  for (int i = 0; i < layout_.size(); ++i)
    if (is_linear_[std::size_t(i)]) linear_.push_back(i);
}

Screening::Solved Screening::solve_linear(std::vector<double> coordinates) const {
  const Observations& at = residuals_.observations();
  const std::size_t count = at.count, n = padded(count);
  const auto rows = Eigen::Index(count);
  const MaterialSpec material = layout_.material(coordinates);
  struct Channel {
    int channel;
    std::vector<int> unknowns;   ///< places in linear_, one a column
    Eigen::MatrixXf columns;     ///< x per unit of an unknown
    Eigen::ArrayXf offset, x, y; ///< x at unknowns 0; x; that of the measurement
  };
  const auto unknown = Eigen::Index(linear_.size());
  Eigen::VectorXd v(unknown), lo(unknown), hi(unknown);
  for (Eigen::Index k = 0; k < unknown; ++k) {
    const FreeParameter& p = layout_[linear_[std::size_t(k)]];
    v[k] = p.value(coordinates[std::size_t(linear_[std::size_t(k)])]);
    lo[k] = p.lo;
    hi[k] = p.hi;
  }
  const Eigen::Map<const Eigen::ArrayXf> cos_i(at.wi[2].data(), rows);
  std::vector<Channel> channels;
  std::vector<float> f(n), df;
  for (const int channel : residuals_.channels()) {
    Channel c{channel, {}, Eigen::MatrixXf(rows, 0), Eigen::ArrayXf::Zero(rows), Eigen::ArrayXf(rows), {}};
    c.y = Eigen::Map<const Eigen::ArrayXf>(at.f[std::size_t(channel)].data(), rows) * cos_i;
    for (std::size_t l = 0; l < material.lobes.size(); ++l) {
      const LobeSpec& lobe = material.lobes[l];
      const ChannelLobe function(lobe, channel);
      std::vector<int> numbers, slots;
      for (std::size_t k = 0; k < function.numbers().size(); ++k) {
        const int slot =
            layout_.index(int(l), function.numbers()[k].parameter, function.numbers()[k].channel);
        if (slot < 0 || !is_linear_[std::size_t(slot)]) continue;
        numbers.push_back(int(k));
        slots.push_back(slot);
      }
      df.resize(numbers.size() * n);
      function.evaluate(function.values(), numbers, at.from(0), n, f.data(), df.data());
      c.offset += float(lobe.weight) * Eigen::Map<const Eigen::ArrayXf>(f.data(), rows) * cos_i;
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        c.unknowns.push_back(int(std::find(linear_.begin(), linear_.end(), slots[k]) - linear_.begin()));
        c.columns.conservativeResize(Eigen::NoChange, c.columns.cols() + 1);
        const auto last = c.columns.cols() - 1;
        c.columns.col(last) =
            (float(lobe.weight) * Eigen::Map<const Eigen::ArrayXf>(&df[k * n], rows) * cos_i).matrix();
        c.offset -= float(v[c.unknowns.back()]) * c.columns.col(last).array();
      }
    }
    channels.push_back(std::move(c));
  }

  const Metric metric = residuals_.metric();
  const bool straight = metric == Metric::cosine || metric == Metric::relative;
  const Eigen::Map<const Eigen::ArrayXf> root(residuals_.root_weight().data(), rows);
  Eigen::ArrayXf weight(rows), compressed(rows);
  const auto error = [&](const Channel& c) {
    for (Eigen::Index i = 0; i < rows; i += Eigen::Index(pack_width)) {
      std::array<float, pack_width> x{}, y{};
      const auto m = std::min<Eigen::Index>(Eigen::Index(pack_width), rows - i);
      std::copy_n(c.x.data() + i, m, x.begin());
      std::copy_n(c.y.data() + i, m, y.begin());
      store(x.data(), metric_error(metric, load(x.data()), load(y.data())));
      std::copy_n(x.begin(), m, compressed.data() + i);
    }
  };
  Eigen::MatrixXd A(unknown, unknown);
  Eigen::VectorXd b(unknown);
  const auto model_x = [&](Channel& c) {
    c.x = c.offset;
    for (std::size_t k = 0; k < c.unknowns.size(); ++k)
      c.x += float(v[c.unknowns[k]]) * c.columns.col(Eigen::Index(k)).array();
  };
  if (unknown > 0)
    for (int round = 0; round < (straight ? 1 : 4); ++round) {
      A.setZero();
      b.setZero();
      for (Channel& c : channels) {
        if (round == 0) {
          if (metric == Metric::log)
            weight = root / (1 + c.y);
          else if (metric == Metric::cube_root)
            weight = root / (c.y + 1e-3f).pow(2 / 3.0f);
          else if (metric == Metric::relative)
            weight = root / (c.y + float(relative_floor));
          else
            weight = root;
        } else {
          error(c);
          const Eigen::ArrayXf d = c.x - c.y,
                               slope_at_y = metric == Metric::log
                                                ? Eigen::ArrayXf(1 / (1 + c.y))
                                                : Eigen::ArrayXf(1 / (3 * (c.y + 1e-6f).pow(2 / 3.0f)));
          weight = root * (d.abs() > 1e-4f * c.y).select(compressed / d, slope_at_y);
        }
        const Eigen::MatrixXf scaled = c.columns.array().colwise() * weight;
        const Eigen::VectorXf target = ((c.y - c.offset) * weight).matrix();
        const Eigen::MatrixXf gram = scaled.transpose() * scaled;
        const Eigen::VectorXf right = scaled.transpose() * target;
        for (std::size_t i = 0; i < c.unknowns.size(); ++i) {
          b[c.unknowns[i]] += double(right[Eigen::Index(i)]);
          for (std::size_t j = 0; j < c.unknowns.size(); ++j)
            A(c.unknowns[i], c.unknowns[j]) += double(gram(Eigen::Index(i), Eigen::Index(j)));
        }
      }
      if (!A.allFinite() || !b.allFinite()) break;
      solve_in_box(A, b, lo, hi, v);
      for (Channel& c : channels)
        model_x(c);
    }
  Solved solved{std::move(coordinates), {}};
  for (Eigen::Index k = 0; k < unknown; ++k) {
    const int slot = linear_[std::size_t(k)];
    solved.coordinates[std::size_t(slot)] = layout_[slot].coordinate(v[k]);
  }
  for (Channel& c : channels) {
    model_x(c);
    error(c);
    const double squares = double((root * compressed).square().sum());
    solved.squares[std::size_t(c.channel)] =
        std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
  }
  return solved;
}

Candidate Screening::solve(std::vector<double> coordinates) const {
  Solved s = solve_linear(std::move(coordinates));
  const double error = s.error();
  return {std::move(s.coordinates), error};
}

std::vector<Candidate> Screening::search(int points, int keep, std::uint64_t seed,
                                         const std::vector<double>& held) const {
  const auto is_held = [&](int i) { return !held.empty() && !std::isnan(held[std::size_t(i)]); };
  bool shared = false, own = false, linear_shared = false; // numbers searched: for all channels, per channel
  for (int i = 0; i < layout_.size(); ++i) {
    if (is_linear_[std::size_t(i)])
      linear_shared = linear_shared || layout_[i].channel < 0;
    else if (is_searched_[std::size_t(i)] && !is_held(i))
      (layout_[i].channel < 0 ? shared : own) = true;
  }
  if (!shared && !own) points = 1;
  // Where each channel has parameters of its own to search, points come in groups of the same shared ones,
  // and each channel takes its best of the group.
  const auto& lobes = layout_.start().lobes;
  const bool mixes = std::any_of(lobes.begin(), lobes.end(), [](const LobeSpec& l) { return bool(l.user); });
  const bool apart = own && !linear_shared && !mixes && residuals_.channels().size() > 1;
  const int group = !apart ? 1 : !shared ? points : std::max(1, int(std::sqrt(double(points))));
  std::vector<Solved> solved(std::size_t((points + group - 1) / group * group));
  parallel_for(solved.size(), [&](std::size_t i) {
    SobolSampler of_point(seed, 0, std::uint32_t(i)),
        of_group(seed, 1, std::uint32_t(i / std::size_t(group)));
    std::vector<double> x = layout_.coordinates(layout_.start());
    double u = 0;
    for (int k = 0; k < layout_.size(); ++k) {
      if (is_held(k)) x[std::size_t(k)] = held[std::size_t(k)];
      if (!is_searched_[std::size_t(k)] || is_held(k)) continue;
      const FreeParameter& p = layout_[k];
      // The channels of a colour start grey.
      if (p.channel <= 0) u = double((p.channel < 0 && group > 1 ? of_group : of_point).next_1d());
      x[std::size_t(k)] = p.coordinate_lo() + u * (p.coordinate_hi() - p.coordinate_lo());
    }
    solved[i] = solve_linear(std::move(x));
  });

  std::vector<Candidate> all;
  for (std::size_t first = 0; first < solved.size(); first += std::size_t(group)) {
    // Of a group the best of each channel together, then the second best, and so on.
    std::array<std::vector<std::size_t>, 3> order;
    for (const int c : residuals_.channels()) {
      auto& o = order[std::size_t(c)];
      o.resize(std::size_t(group));
      std::iota(o.begin(), o.end(), first);
      std::stable_sort(o.begin(), o.end(), [&](std::size_t a, std::size_t b) {
        return solved[a].squares[std::size_t(c)] < solved[b].squares[std::size_t(c)];
      });
    }
    for (std::size_t rank = 0; rank < std::size_t(std::min(group, shared ? 2 : 4 * keep)); ++rank) {
      const int front = residuals_.channels().front();
      Candidate candidate{solved[order[std::size_t(front)][rank]].coordinates, 0};
      double squares = 0;
      for (const int c : residuals_.channels()) {
        const Solved& s = solved[order[std::size_t(c)][rank]];
        squares += s.squares[std::size_t(c)];
        for (int k = 0; k < layout_.size(); ++k)
          if (layout_[k].channel == c) candidate.coordinates[std::size_t(k)] = s.coordinates[std::size_t(k)];
      }
      candidate.error = std::sqrt(squares);
      all.push_back(std::move(candidate));
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
  std::vector<Candidate> best;
  // Neighbours lead to the same optimum: a tenth of the range apart in one coordinate at least.
  for (const double apart_by : {0.1, 0.0})
    for (const Candidate& c : all) {
      if (int(best.size()) == keep || !std::isfinite(c.error)) break;
      const auto near = [&](const Candidate& chosen) {
        for (int k = 0; k < layout_.size(); ++k)
          if (!is_linear_[std::size_t(k)] &&
              std::abs(c.coordinates[std::size_t(k)] - chosen.coordinates[std::size_t(k)]) >
                  apart_by * (layout_[k].coordinate_hi() - layout_[k].coordinate_lo()))
            return false;
        return true;
      };
      if (std::none_of(best.begin(), best.end(), near)) best.push_back(c);
    }
  std::stable_sort(best.begin(), best.end(),
                   [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
  return best;
}

} // namespace nacre
