#include "fit/residuals.h"

#include "core/pack.h"
#include "core/parallel.h"
#include "fit/channel_lobe.h"

#include <limits>
#include <numeric>

namespace nacre {
namespace {

/// Directions evaluated at once: their values and derivatives fit the first-level cache.
constexpr std::size_t block_size = 256;
/// Directions of a unit of parallel work, the same for any number of threads.
constexpr std::size_t part_size = 8192;

} // namespace

/// What one channel depends on: its lobes, and which coordinates, one a column of its Jacobian.
struct Residuals::ChannelPlan {
  struct Derivative {
    int column;
    float scale; ///< d value / d coordinate, times the lobe's weight
  };
  struct Lobe {
    ChannelLobe function;
    float weight;
    std::vector<int> numbers; ///< to differentiate by
    std::vector<Derivative> derivatives;
  };
  int channel;
  std::vector<Lobe> lobes;
  std::vector<int> slots; ///< of the layout, one a column
};

/// Residuals of a block of nodes of a channel, with room to compute them in.
struct Residuals::Block {
  std::array<float, block_size> f, sum, x, error, slope; ///< error: s (y - y_measured); slope: s y'
  std::vector<float> df;
  Eigen::MatrixXf jacobian; ///< d error / d coordinate, a row a node
};

Residuals::Residuals(const Observations& observations, Metric metric, const ParameterLayout& layout,
                     RobustLoss loss, int channel)
    : at_(observations), metric_(metric), layout_(layout), loss_(loss) {
  if (channel < 0)
    channels_ = {0, 1, 2};
  else
    channels_ = {channel};
  set_num_residuals(int(channels_.size() * at_.count));
  mutable_parameter_block_sizes()->push_back(layout.size());
  const double sum = std::accumulate(at_.weight.begin(), at_.weight.end(), 0.0);
  for (const double w : at_.weight)
    root_weight_.push_back(float(std::sqrt(w / (double(channels_.size()) * sum))));
  for (const int c : channels_)
    for (std::size_t n = 0; n < at_.count; ++n) {
      const double y = double(at_.f[std::size_t(c)][n]) * double(at_.wi[2][n]);
      const double change = metric_slope(metric, y, y) * y;
      rounding_cost_ += 0.5 * sqr(4e-7 * double(root_weight_[n]) * change);
    }
}

Residuals::ChannelPlan Residuals::plan(const MaterialSpec& material, std::span<const double> coordinates,
                                       int channel) const {
  ChannelPlan plan{channel, {}, {}};
  std::vector<int> column(std::size_t(layout_.size()), -1);
  for (std::size_t l = 0; l < material.lobes.size(); ++l) {
    const LobeSpec& lobe = material.lobes[l];
    ChannelPlan::Lobe part{ChannelLobe(lobe, channel), float(lobe.weight), {}, {}};
    const auto& numbers = part.function.numbers();
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const int slot = layout_.index(int(l), numbers[k].parameter, numbers[k].channel);
      if (slot < 0) continue;
      int& c = column[std::size_t(slot)]; // tied parameters share one
      if (c < 0) {
        c = int(plan.slots.size());
        plan.slots.push_back(slot);
      }
      part.numbers.push_back(int(k));
      part.derivatives.push_back(
          {c, float(lobe.weight * layout_[slot].slope(coordinates[std::size_t(slot)]))});
    }
    plan.lobes.push_back(std::move(part));
  }
  return plan;
}

void Residuals::fill(const ChannelPlan& plan, std::size_t begin, std::size_t n, bool with_jacobian,
                     Block& b) const {
  const std::size_t padded = (n + pack_width - 1) / pack_width * pack_width;
  const auto rows = Eigen::Index(padded);
  if (with_jacobian) b.jacobian.setZero(rows, Eigen::Index(plan.slots.size()));
  std::fill_n(b.sum.begin(), padded, 0.0f);
  for (const ChannelPlan::Lobe& lobe : plan.lobes) {
    if (with_jacobian) b.df.resize(lobe.numbers.size() * padded);
    lobe.function.evaluate(lobe.function.values(), lobe.numbers, at_.from(begin), padded, b.f.data(),
                           with_jacobian ? b.df.data() : nullptr);
    for (std::size_t i = 0; i < padded; ++i)
      b.sum[i] += lobe.weight * b.f[i];
    if (!with_jacobian) continue;
    for (std::size_t k = 0; k < lobe.numbers.size(); ++k)
      b.jacobian.col(lobe.derivatives[k].column) +=
          lobe.derivatives[k].scale * Eigen::Map<const Eigen::VectorXf>(&b.df[k * padded], rows);
  }
  for (std::size_t i = 0; i < padded; i += pack_width) {
    const Pack cos_i = load(&at_.wi[2][begin + i]);
    const Pack x = load(&b.sum[i]) * cos_i, y = load(&at_.f[std::size_t(plan.channel)][begin + i]) * cos_i;
    const Pack slope = metric_slope(metric_, x, y);
    store(&b.x[i], x);
    store(&b.error[i], metric_error(metric_, x, y));
    store(&b.slope[i], slope);
    if (with_jacobian) store(&b.f[i], slope * cos_i);
  }
  if (with_jacobian) {
    const Eigen::Map<const Eigen::ArrayXf> outer(b.f.data(), rows);
    b.jacobian.array().colwise() *= outer;
  }
}

bool Residuals::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const std::size_t width = std::size_t(layout_.size()), rows = channels_.size() * at_.count;
  const std::span<const double> coordinates(parameters[0], width);
  double* jacobian = jacobians ? jacobians[0] : nullptr;
  if (jacobian) std::fill(jacobian, jacobian + rows * width, 0.0);
  const MaterialSpec material = layout_.material(coordinates);
  Block block;
  std::size_t row = 0;
  for (const int channel : channels_) {
    const ChannelPlan columns = plan(material, coordinates, channel);
    for (std::size_t begin = 0; begin < at_.count; begin += block_size) {
      const std::size_t n = std::min(block_size, at_.count - begin);
      fill(columns, begin, n, jacobian != nullptr, block);
      for (std::size_t i = 0; i < n; ++i, ++row) {
        const double root = root_weight_[begin + i];
        residuals[row] = root * block.error[i];
        if (!jacobian) continue;
        for (std::size_t k = 0; k < columns.slots.size(); ++k)
          jacobian[row * width + std::size_t(columns.slots[k])] =
              root * block.jacobian(Eigen::Index(i), Eigen::Index(k));
      }
    }
  }
  return std::all_of(residuals, residuals + rows, [](double r) { return std::isfinite(r); });
}

template <class Partial, class F, class G>
void Residuals::sum_over_blocks(std::span<const double> coordinates, bool with_jacobian, F add,
                                G gather) const {
  const MaterialSpec material = layout_.material(coordinates);
  std::vector<ChannelPlan> plans;
  for (const int channel : channels_)
    plans.push_back(plan(material, coordinates, channel));
  const std::size_t parts = (at_.count + part_size - 1) / part_size;
  std::vector<Partial> sums(plans.size() * parts);
  const auto body = [&](std::size_t task) {
    const ChannelPlan& columns = plans[task / parts];
    const std::size_t first = task % parts * part_size, last = std::min(first + part_size, at_.count);
    Block block;
    for (std::size_t begin = first; begin < last; begin += block_size) {
      const std::size_t n = std::min(block_size, last - begin);
      fill(columns, begin, n, with_jacobian, block);
      add(sums[task], columns, block, begin, n);
    }
  };
  if (parts == 1)
    for (std::size_t task = 0; task < sums.size(); ++task)
      body(task);
  else
    parallel_for(sums.size(), body);
  for (std::size_t task = 0; task < sums.size(); ++task) // in order: the same for any number of threads
    gather(sums[task], plans[task / parts]);
}

double Residuals::cost(std::span<const double> coordinates) const {
  double total = 0;
  const double scale2 = sqr(loss_.scale);
  sum_over_blocks<double>(
      coordinates, false,
      [&](double& sum, const ChannelPlan&, const Block& b, std::size_t begin, std::size_t n) {
        double part = 0;
        if (loss_.kind == LossKind::squares)
          for (std::size_t i = 0; i < n; ++i)
            part += double(sqr(root_weight_[begin + i] * b.error[i]));
        else
          for (std::size_t i = 0; i < n; ++i)
            part += double(sqr(root_weight_[begin + i])) * scale2 *
                    loss_.at(sqr(double(b.error[i])) / scale2).rho;
        sum += part;
      },
      [&](double sum, const ChannelPlan&) { total += 0.5 * sum; });
  return std::isfinite(total) ? total : std::numeric_limits<double>::infinity();
}

bool Residuals::slope(std::span<const double> coordinates, CostSlope& out) const {
  struct Partial {
    double squares = 0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd matrix;
  };
  const Eigen::Index width = layout_.size();
  out.cost = 0;
  out.gradient.setZero(width);
  out.gauss_newton.setZero(width, width);
  const double scale2 = sqr(loss_.scale);
  sum_over_blocks<Partial>(
      coordinates, true,
      [&](Partial& sum, const ChannelPlan& columns, Block& b, std::size_t begin, std::size_t n) {
        const auto k = Eigen::Index(columns.slots.size());
        if (sum.gradient.size() == 0) {
          sum.gradient.setZero(k);
          sum.matrix.setZero(k, k);
        }
        std::array<float, block_size> root, weighted; // roots of weight and slope of rho; times the error
        double part = 0;
        for (std::size_t i = 0; i < n; ++i) {
          root[i] = root_weight_[begin + i];
          if (loss_.kind == LossKind::squares) {
            weighted[i] = root[i] * b.error[i];
            part += double(sqr(weighted[i]));
          } else {
            const auto rho = loss_.at(sqr(double(b.error[i])) / scale2);
            part += double(sqr(root[i])) * scale2 * rho.rho;
            root[i] *= float(std::sqrt(rho.slope));
            weighted[i] = root[i] * b.error[i];
          }
        }
        sum.squares += part;
        const auto rows = Eigen::Index(n);
        auto J = b.jacobian.topRows(rows);
        J.array().colwise() *= Eigen::Map<const Eigen::ArrayXf>(root.data(), rows);
        sum.gradient +=
            (J.transpose() * Eigen::Map<const Eigen::VectorXf>(weighted.data(), rows)).cast<double>();
        sum.matrix += (J.transpose() * J).eval().cast<double>();
      },
      [&](const Partial& sum, const ChannelPlan& columns) {
        out.cost += 0.5 * sum.squares;
        for (Eigen::Index a = 0; a < sum.gradient.size(); ++a) {
          out.gradient[columns.slots[std::size_t(a)]] += sum.gradient[a];
          for (Eigen::Index b = 0; b < sum.gradient.size(); ++b)
            out.gauss_newton(columns.slots[std::size_t(a)], columns.slots[std::size_t(b)]) +=
                sum.matrix(a, b);
        }
      });
  return std::isfinite(out.cost) && out.gradient.allFinite() && out.gauss_newton.allFinite();
}

NoiseSums Residuals::noise_sums(std::span<const double> coordinates) const {
  struct Partial {
    double squares = 0;
    Eigen::MatrixXd bread, meat;
    Eigen::VectorXd noise, rounding;
  };
  const Eigen::Index width = layout_.size();
  NoiseSums out;
  out.bread.setZero(width, width);
  out.meat.setZero(width, width);
  out.noise.setZero(width);
  out.rounding.setZero(width);
  out.rows = channels_.size() * at_.count;
  const bool plain = loss_.kind == LossKind::squares;
  const double scale2 = sqr(loss_.scale);
  sum_over_blocks<Partial>(
      coordinates, true,
      [&](Partial& sum, const ChannelPlan& columns, Block& b, std::size_t begin, std::size_t n) {
        const auto k = Eigen::Index(columns.slots.size());
        if (sum.noise.size() == 0) {
          sum.noise.setZero(k);
          sum.rounding.setZero(k);
          sum.bread.setZero(k, k);
          sum.meat.setZero(k, k);
        }
        const auto rows = Eigen::Index(n);
        const Eigen::MatrixXd J = b.jacobian.topRows(rows).cast<double>().array().colwise() *
                                  Eigen::Map<const Eigen::ArrayXf>(&root_weight_[begin], rows).cast<double>();
        Eigen::ArrayXd bread(rows), psi(rows), noise(rows), rounding(rows);
        for (std::size_t i = 0; i < n; ++i) {
          const double root = root_weight_[begin + i], e = b.error[i], x = b.x[i];
          const double s = plain ? 0 : sqr(e) / scale2;
          const auto rho = loss_.at(s);
          sum.squares += sqr(root * e);
          const auto at = Eigen::Index(i);
          psi[at] = root * e * rho.slope;
          bread[at] = std::max(rho.slope + 2 * s * rho.curvature, 0.0); // psi'
          // Noise of variance v shifts the mean of a curved y by y'' v / 2, and v = (e / y')^2 if e is noise:
          // by e^2 times y'' / (2 y'^2). The noisy divisor of `relative` makes small values count more: by
          // the square of the relative noise in the residual, and as much in its weight.
          const double bend = metric_ == Metric::log         ? 0.5
                              : metric_ == Metric::cube_root ? 1 / std::cbrt(std::max(x, cube_root_floor))
                              : metric_ == Metric::relative  ? 2.0
                                                             : 0.0;
          noise[at] = bend * root * sqr(e) * rho.slope;
          rounding[at] = 1e-6 * root * b.slope[i] * x;
        }
        sum.bread += J.transpose() * (J.array().colwise() * bread).matrix();
        const Eigen::MatrixXd scored = J.array().colwise() * psi;
        sum.meat += scored.transpose() * scored;
        sum.noise += J.transpose() * noise.matrix();
        sum.rounding += J.transpose() * rounding.matrix();
      },
      [&](const Partial& sum, const ChannelPlan& columns) {
        out.squares += sum.squares;
        for (Eigen::Index a = 0; a < sum.noise.size(); ++a) {
          const int i = columns.slots[std::size_t(a)];
          out.noise[i] += sum.noise[a];
          out.rounding[i] += sum.rounding[a];
          for (Eigen::Index b = 0; b < sum.noise.size(); ++b) {
            const int j = columns.slots[std::size_t(b)];
            out.bread(i, j) += sum.bread(a, b);
            out.meat(i, j) += sum.meat(a, b);
          }
        }
      });
  return out;
}

double Residuals::median_residual(std::span<const double> coordinates) const {
  std::vector<float> sizes;
  std::vector<std::vector<float>> parts;
  sum_over_blocks<std::vector<float>>(
      coordinates, false,
      [](std::vector<float>& part, const ChannelPlan&, const Block& b, std::size_t, std::size_t n) {
        for (std::size_t i = 0; i < n; ++i)
          part.push_back(std::abs(b.error[i]));
      },
      [&](const std::vector<float>& part, const ChannelPlan&) {
        sizes.insert(sizes.end(), part.begin(), part.end());
      });
  std::nth_element(sizes.begin(), sizes.begin() + std::ptrdiff_t(sizes.size() / 2), sizes.end());
  return double(sizes[sizes.size() / 2]);
}

std::optional<int> Residuals::invisible_lobe(const std::vector<double>& coordinates) const {
  const MaterialSpec material = layout_.material(coordinates);
  const std::size_t n = (at_.count + pack_width - 1) / pack_width * pack_width;
  const auto zero = [](const std::vector<float>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return x == 0; });
  };
  const ChannelPlan columns = plan(material, coordinates, channels_.front());
  for (std::size_t l = 0; l < columns.lobes.size(); ++l) {
    const ChannelPlan::Lobe& lobe = columns.lobes[l];
    std::vector<float> f(n), df(n * lobe.numbers.size());
    lobe.function.evaluate(lobe.function.values(), lobe.numbers, at_.from(0), n, f.data(), df.data());
    if (zero(f) && zero(df)) return int(l);
  }
  return {};
}

} // namespace nacre
