#include "fit/fit.h"

#include "core/error.h"
#include "core/parallel.h"
#include "fit/minimise.h"
#include "fit/screening.h"
#include "fit/uncertainty.h"
#include "measured/merl_table.h"

#include <chrono>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>

namespace nacre {

/// Nodes by what selects them, made when they are first asked for.
struct FitData::Grids {
  using Key = std::array<double, 6>;
  std::mutex mutex;
  std::map<Key, std::shared_ptr<const Observations>> made;

  std::shared_ptr<const Observations> get(const MeasuredBsdf& measured, const NodeSelection& s) {
    const Key key{double(s.theta_h_step), double(s.theta_d_step), double(s.phi_d_step),
                  double(s.sample_step),  s.max_theta_deg,        double(s.turned)};
    const std::lock_guard lock(mutex);
    auto& nodes = made[key];
    if (!nodes) nodes = std::make_shared<const Observations>(observe(measured, s));
    return nodes;
  }
};

FitData::FitData(const MeasuredBsdf& measured) : measured_(measured), grids_(std::make_unique<Grids>()) {}
FitData::~FitData() = default;

namespace {

struct Optimum {
  std::vector<double> coordinates;
  double error = std::numeric_limits<double>::infinity(); ///< E over the grid
  int iterations = 0;
  bool converged = false;

  Optimum() = default;
  Optimum(Minimum m)
      : coordinates(std::move(m.coordinates)), error(std::sqrt(2 * m.cost)), iterations(m.iterations),
        converged(m.converged) {}
};

/// Levenberg and Marquardt's method into the neighbourhood of the optimum, Newton's for the rest.
Optimum optimise(const Residuals& residuals, std::vector<double> x, int max_iterations,
                 const OnStep& on_step) {
  Minimum m = levenberg_marquardt(residuals, std::move(x), max_iterations, 1e-4, on_step);
  if (!std::isfinite(m.cost)) return m;
  const int before = m.iterations;
  // Enough to rank optima.
  m = newton(residuals, std::move(m.coordinates), max_iterations, 1e-6, residuals, on_step);
  m.iterations += before;
  return m;
}

/// The optimum, not stopped by a bound where the slope vanishes: a metal's reflectance depends on the square
/// of its absorption k, so a step that was cut off at k = 0 never leaves again. What ended at such a bound is
/// put a tenth of its range inside and tried once more.
Optimum optimise_off_bounds(const Residuals& residuals, std::vector<double> x, int max_iterations,
                            const OnStep& on_step) {
  Optimum first = optimise(residuals, std::move(x), max_iterations, on_step);
  if (!std::isfinite(first.error)) return first;
  std::vector<double> inside = first.coordinates;
  const ParameterLayout& layout = residuals.layout();
  std::vector<int> at_end;
  for (int i = 0; i < layout.size(); ++i) {
    double& c = inside[std::size_t(i)];
    const double lo = layout[i].coordinate_lo(), hi = layout[i].coordinate_hi();
    if (!at_bound(layout[i], c)) continue;
    c = c - lo < hi - c ? lo + 0.1 * (hi - lo) : hi - 0.1 * (hi - lo);
    at_end.push_back(i);
  }
  CostSlope there, here;
  if (at_end.empty() || !residuals.slope(first.coordinates, here) || !residuals.slope(inside, there))
    return first;
  bool flat = false;
  for (const int i : at_end)
    if (here.gauss_newton(i, i) < 1e-4 * there.gauss_newton(i, i))
      flat = true;
    else
      inside[std::size_t(i)] = first.coordinates[std::size_t(i)];
  if (!flat) return first;
  Optimum second = optimise(residuals, std::move(inside), max_iterations, on_step);
  const int iterations = first.iterations + second.iterations;
  Optimum& better = second.error < first.error ? second : first;
  better.iterations = iterations;
  return std::move(better);
}

/// What the caller of a fit sees of it, and whether it is to go on.
class Watch {
public:
  Watch(const FitOptions& options, const ParameterLayout& layout) : options_(options), layout_(layout) {}

  bool stopped() const { return stop_requested() || (options_.stopped && options_.stopped()); }
  /// @throws Error if the fit is not to go on
  void check() const {
    if (stopped()) throw Error("the fit was stopped");
  }
  /// @param from, to  what share of the whole fit the `descents` of the stage are
  void begin_stage(std::size_t descents, double from, double to) {
    best_ = std::numeric_limits<double>::infinity();
    descents_ = descents, ended_ = 0, from_ = from, to_ = to;
  }
  void end_descent() {
    const std::lock_guard lock(mutex_);
    ++ended_;
  }
  OnStep on_step() {
    return [this](std::span<const double> x, double cost) {
      if (options_.on_better) tell(x, cost);
      return !stopped();
    };
  }
  /// For a descent whose coordinates are not those of the whole fit.
  OnStep on_hidden_step() const {
    return [this](std::span<const double>, double) { return !stopped(); };
  }

private:
  void tell(std::span<const double> x, double cost) {
    const std::lock_guard lock(mutex_);
    ++iterations_;
    if (!(cost < best_)) return;
    best_ = cost;
    MaterialSpec material = layout_.material(x);
    material.name = options_.model;
    const double done = double(ended_) / double(std::max<std::size_t>(descents_, 1));
    options_.on_better({material, std::sqrt(2 * cost), iterations_, from_ + (to_ - from_) * done});
  }

  const FitOptions& options_;
  const ParameterLayout& layout_;
  std::mutex mutex_;
  double best_ = std::numeric_limits<double>::infinity();
  std::size_t descents_ = 1, ended_ = 0;
  double from_ = 0, to_ = 1;
  int iterations_ = 0;
};

void check(const FitOptions& o) {
  if (o.starts < 1 || o.starts > 100000)
    throw Error(fmt::format("a fit has 1 to 100000 starts, found {}", o.starts));
  if (o.refined < 1) throw Error(fmt::format("a fit refines at least 1 start, found {}", o.refined));
  if (o.screened < 1 || o.screened > 10000000)
    throw Error(fmt::format("a fit screens 1 to 10000000 points, found {}", o.screened));
  if (o.max_iterations < 1)
    throw Error(fmt::format("a fit takes at least 1 iteration, found {}", o.max_iterations));
  if (o.theta_d_step < 0 || o.phi_d_step < 0)
    throw Error(fmt::format("steps between the nodes of a fit are not negative, found {}, {}", o.theta_d_step,
                            o.phi_d_step));
  if (o.kept_angles < 1 || o.kept_angles > 10000)
    throw Error(fmt::format("1 to 10000 angles are kept, found {}", o.kept_angles));
  if (o.channel < -1 || o.channel > 2)
    throw Error(fmt::format("a channel is 0, 1 or 2, or -1 for all, found {}", o.channel));
  if (!(o.confidence > 0 && o.confidence < 1))
    throw Error(fmt::format("a confidence lies between 0 and 1, found {}", o.confidence));
  if (!(o.loss.scale >= 0))
    throw Error(fmt::format("the scale of a loss is not negative, found {}", o.loss.scale));
}

void check_exact(const MaterialSpec& material) {
  for (const LobeSpec& lobe : material.lobes)
    if (!lobe.is_table() && model_info(lobe).laws.stochastic)
      throw Error(
          fmt::format("{} gives an estimate by chance for each pair of directions, not a value: it has no "
                      "residuals and cannot be fitted",
                      model_info(lobe).name));
}

/// Positions of the best distinct optima: of those with the same error the first.
std::vector<std::size_t> best_of(const std::vector<Optimum>& optima, int count) {
  std::vector<std::size_t> order(optima.size()), best;
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return optima[a].error < optima[b].error; });
  for (const std::size_t i : order) {
    if (!std::isfinite(optima[i].error) || best.size() == std::size_t(count)) break;
    // What is a quarter worse on every second node is not best on all.
    if (!best.empty() && optima[i].error > 1.25 * optima[best.front()].error) break;
    if (best.empty() || optima[i].error > optima[best.back()].error * (1 + 1e-3)) best.push_back(i);
  }
  return best;
}

/// What the global stage works on.
struct CoarseStage {
  const Observations &screen, &coarse;
  const FitOptions& options;
  ParameterRules rules;
  const Watch& watch;

  Residuals residuals(const Observations& nodes, const ParameterLayout& layout) const {
    return Residuals(nodes, options.metric, layout, {}, options.channel);
  }
};

/// Lobes with something to search: parameters that are not affine.
std::vector<int> searched_lobes(const ParameterLayout& layout, const std::vector<int>& linear) {
  std::vector<int> lobes;
  for (int i = 0; i < layout.size(); ++i)
    if (!std::binary_search(linear.begin(), linear.end(), i) &&
        (lobes.empty() || lobes.back() != layout[i].lobe))
      lobes.push_back(layout[i].lobe);
  return lobes;
}

/// Starts for a sum of several lobes that have to be searched: the best fit without one of them, and the best
/// place for that one beside it. So a sum is at least as good as its parts.
std::vector<Candidate> nested_starts(const CoarseStage& stage, const ParameterLayout& layout,
                                     const Screening& screening) {
  std::vector<Candidate> starts;
  const std::vector<int> lobes = searched_lobes(layout, screening.linear());
  const ParameterRules& r = stage.rules;
  // Rules name lobes of the whole sum.
  if (lobes.size() < 2 || !r.shared.empty() || !r.freed.empty() || !r.fixed.empty() || !r.bounds.empty())
    return starts;
  std::vector<std::string> tried; // models: of two lobes of the same model one is left out
  for (const int left_out : lobes) {
    const std::string& model = model_info(layout.start().lobes[std::size_t(left_out)]).name;
    if (std::find(tried.begin(), tried.end(), model) != tried.end()) continue;
    tried.push_back(model);
    MaterialSpec part = layout.start();
    part.lobes.erase(part.lobes.begin() + left_out);
    const ParameterLayout part_layout(part, stage.rules);
    const Residuals on_screen = stage.residuals(stage.screen, part_layout),
                    on_coarse = stage.residuals(stage.coarse, part_layout);
    const Screening search(on_screen);
    std::vector<Candidate> candidates = search.search(stage.options.screened / 2, 3, stage.options.seed);
    for (const Candidate& nested : nested_starts(stage, part_layout, search))
      candidates.push_back(nested);
    Minimum best;
    best.cost = std::numeric_limits<double>::infinity();
    for (Candidate& c : candidates) {
      stage.watch.check();
      Minimum m = levenberg_marquardt(on_coarse, std::move(c.coordinates), stage.options.max_iterations, 1e-4,
                                      stage.watch.on_hidden_step());
      if (m.cost < best.cost) best = std::move(m);
    }
    if (!std::isfinite(best.cost)) continue;
    // The optimum of the part in the layout of the sum.
    std::vector<double> held(std::size_t(layout.size()), std::numeric_limits<double>::quiet_NaN());
    for (int i = 0; i < layout.size(); ++i) {
      const FreeParameter& p = layout[i];
      if (p.lobe == left_out) continue;
      const int slot = part_layout.index(p.lobe - (p.lobe > left_out), p.parameter, std::max(p.channel, 0));
      held[std::size_t(i)] = best.coordinates[std::size_t(slot)];
    }
    for (Candidate& c : screening.search(stage.options.screened / 2, 2, stage.options.seed + 1, held))
      starts.push_back(std::move(c));
  }
  return starts;
}

/// Lobes of the same model in ascending order of their first number for all channels (roughness), so that the
/// order does not depend on the start.
std::vector<double> sorted_lobes(const ParameterLayout& layout, std::vector<double> x) {
  const auto& lobes = layout.start().lobes;
  std::vector<std::vector<int>> slots(lobes.size());
  std::vector<int> key(lobes.size(), -1);
  for (int i = 0; i < layout.size(); ++i) {
    auto& of_lobe = slots[std::size_t(layout[i].lobe)];
    if (layout[i].channel < 0 && key[std::size_t(layout[i].lobe)] < 0)
      key[std::size_t(layout[i].lobe)] = int(of_lobe.size());
    of_lobe.push_back(i);
  }
  const auto alike = [&](std::size_t a, std::size_t b) {
    if (!same_model(lobes[a], lobes[b]) || lobes[a].weight != lobes[b].weight || key[a] < 0 ||
        key[a] != key[b] || slots[a].size() != slots[b].size())
      return false;
    for (std::size_t k = 0; k < slots[a].size(); ++k) {
      const FreeParameter &p = layout[slots[a][k]], &q = layout[slots[b][k]];
      if (p.parameter != q.parameter || p.channel != q.channel || p.lo != q.lo || p.hi != q.hi) return false;
    }
    const ModelInfo& model = model_info(lobes[a]);
    for (std::size_t p = 0; p < model.parameters.size(); ++p)
      if (layout.index(int(a), int(p), 0) < 0 && lobes[a].values[p] != lobes[b].values[p]) return false;
    return true;
  };
  for (std::size_t a = 0; a < lobes.size(); ++a)
    for (std::size_t b = a + 1; b < lobes.size(); ++b)
      if (alike(a, b) &&
          x[std::size_t(slots[a][std::size_t(key[a])])] > x[std::size_t(slots[b][std::size_t(key[b])])])
        for (std::size_t k = 0; k < slots[a].size(); ++k)
          std::swap(x[std::size_t(slots[a][k])], x[std::size_t(slots[b][k])]);
  return x;
}

std::vector<FittedParameter> describe(const Residuals& residuals, const std::vector<double>& x,
                                      double confidence) {
  const ParameterLayout& layout = residuals.layout();
  const NoiseSums sums = residuals.noise_sums(x);
  std::vector<bool> held;
  for (int i = 0; i < layout.size(); ++i)
    held.push_back(at_bound(layout[i], x[std::size_t(i)]));
  const Uncertainty u = estimate_uncertainty(sums, held);
  // The truth may lie inside of a bound at which the noise has left an estimate: intervals let all move.
  const Uncertainty all = estimate_uncertainty(sums, std::vector<bool>(held.size(), false));
  const double quantile = simultaneous_quantile(confidence, layout.size());
  std::vector<FittedParameter> parameters_out;
  for (int i = 0; i < layout.size(); ++i) {
    const FreeParameter& p = layout[i];
    const std::size_t k = std::size_t(i);
    const ModelInfo& model = model_info(layout.start().lobes[std::size_t(p.lobe)]);
    const ParameterInfo& info = model.parameters[std::size_t(p.parameter)];
    const double slope = p.slope(x[k]);
    // An error bar as wide as half the domain is none.
    const bool identifiable = u.identifiable[k] && !(slope * u.standard_error[k] > 0.5 * (p.hi - p.lo));
    const double half = quantile * all.standard_error[k] + all.shift[k];
    const bool bounded = identifiable && std::isfinite(half);
    parameters_out.push_back({layout.label(i), model.name, info.name, info.unit, p.lobe, p.channel,
                              p.value(x[k]), p.lo, p.hi, slope * u.standard_error[k],
                              slope * u.uniform_noise_error[k], held[k], identifiable,
                              u.partner[k] < 0 ? "" : layout.label(u.partner[k]), u.correlation[k],
                              p.tied < 0 ? "" : model.parameters[std::size_t(p.tied)].name,
                              bounded ? p.value(x[k] - half) : p.lo, bounded ? p.value(x[k] + half) : p.hi});
    for (int j = 0; j < layout.size(); ++j)
      parameters_out.back().covariance.push_back(slope * layout[j].slope(x[std::size_t(j)]) *
                                                 u.covariance[k * x.size() + std::size_t(j)]);
  }
  return parameters_out;
}

} // namespace

FitResult fit(const MeasuredBsdf& measured, const FitOptions& options) {
  return fit(FitData(measured), options);
}

FitResult fit(const FitData& data, const FitOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  check(options);
  const MeasuredBsdf& measured = data.measured();
  const MaterialSpec material = parse_material(options.model, options.find_file);
  check_exact(material);
  ParameterRules rules = options.rules;
  rules.isotropic = options.isotropic;
  if (options.channel >= 0) // one channel has one number of everything
    for (const LobeSpec& lobe : material.lobes)
      if (!lobe.is_table())
        for (const ParameterInfo& p : model_info(lobe).parameters)
          rules.shared.push_back(p.name);
  const ParameterLayout layout(material, rules);

  NodeSelection every, fine;
  every.max_theta_deg = fine.max_theta_deg = options.max_theta_deg;
  every.turned = fine.turned = !options.isotropic;
  if (const auto* table = dynamic_cast<const MerlTable*>(&measured)) {
    fine.theta_d_step = options.theta_d_step > 0 ? options.theta_d_step
                                                 : std::max(1, table->n_theta_d() / options.kept_angles);
    fine.phi_d_step =
        options.phi_d_step > 0 ? options.phi_d_step : std::max(1, table->n_phi_d() / options.kept_angles);
  } else {
    const std::size_t enough = 70 * std::size_t(sqr(options.kept_angles)); // as many as of a MERL table
    fine.sample_step = int((measured.samples().size() + enough - 1) / enough);
    fine.sample_step = std::max(fine.sample_step, 1);
  }
  NodeSelection coarse = fine, screen;
  coarse.theta_h_step = 2;
  coarse.theta_d_step *= 3;
  coarse.phi_d_step *= 3;
  coarse.sample_step *= 17; // a prime: in step with no axis of a grid
  screen = coarse;
  screen.theta_d_step *= 2;
  screen.phi_d_step *= 2;
  screen.sample_step *= 3;

  auto& grids = *data.grids_;
  const auto fine_nodes = grids.get(measured, fine);
  if (fine_nodes->count <= std::size_t(layout.size()))
    throw Error(
        fmt::format("{} parameters cannot be fitted to {} measured values with both angles below {} degrees",
                    layout.size(), fine_nodes->count, options.max_theta_deg));
  const auto enough = [&](const std::shared_ptr<const Observations>& nodes) {
    return nodes->count >= 20 * std::size_t(layout.size());
  };
  auto coarse_nodes = grids.get(measured, coarse), screen_nodes = grids.get(measured, screen);
  if (!enough(coarse_nodes)) coarse_nodes = fine_nodes; // a small table
  if (!enough(screen_nodes)) screen_nodes = coarse_nodes;
  Residuals on_coarse(*coarse_nodes, options.metric, layout, {}, options.channel),
      on_fine(*fine_nodes, options.metric, layout, {}, options.channel);
  if (const auto lobe = on_coarse.invisible_lobe(layout.coordinates(layout.start())))
    throw Error(
        fmt::format("{} reflects into the mirror direction alone, which no table holds: it cannot be fitted",
                    model_info(layout.start().lobes[std::size_t(*lobe)]).name));

  Watch watch(options, layout);
  std::vector<std::vector<double>> starts{layout.coordinates(layout.start())};
  if (options.starts > 1) {
    const CoarseStage stage{*screen_nodes, *coarse_nodes, options, rules, watch};
    const Residuals on_screen = stage.residuals(*screen_nodes, layout);
    const Screening screening(on_screen);
    for (Candidate& c : screening.search(options.screened, options.starts - 1, options.seed))
      starts.push_back(std::move(c.coordinates));
    for (Candidate& c : nested_starts(stage, layout, screening))
      starts.push_back(std::move(c.coordinates));
  }
  std::vector<Optimum> optima(starts.size());
  watch.check();
  watch.begin_stage(optima.size(), 0.1, 0.6);
  parallel_for(optima.size(), [&](std::size_t i) {
    if (watch.stopped()) return;
    optima[i] = optimise_off_bounds(on_coarse, starts[i], options.max_iterations, watch.on_step());
    watch.end_descent();
  });
  const std::vector<std::size_t> chosen = best_of(optima, options.refined);
  watch.check();
  if (chosen.empty()) throw Error(fmt::format("{}: no start led to finite values", options.model));

  FitResult result;
  result.loss = options.loss;
  if (options.loss.kind != LossKind::squares) {
    if (options.loss.scale == 0)
      result.loss.scale = std::max(3 * on_fine.median_residual(optima[chosen.front()].coordinates), 1e-9);
    on_coarse.set_loss(result.loss);
    on_fine.set_loss(result.loss);
  }
  std::vector<Optimum> refined(chosen.size());
  watch.begin_stage(chosen.size(), 0.6, 0.9);
  parallel_for(chosen.size(), [&](std::size_t i) {
    if (watch.stopped()) return;
    std::vector<double> x = optima[chosen[i]].coordinates;
    if (options.loss.kind != LossKind::squares)
      x = optimise(on_coarse, std::move(x), options.max_iterations, watch.on_hidden_step()).coordinates;
    refined[i] =
        newton(on_fine, std::move(x), std::min(options.max_iterations, 15), 1e-6, on_coarse, watch.on_step());
    if (!refined[i].converged &&
        options.every_node) // the coarse grid's curvature does not fit: the grid's own
      refined[i] = newton(on_fine, std::move(refined[i].coordinates), std::min(options.max_iterations, 50),
                          1e-6, on_fine, watch.on_step());
    watch.end_descent();
  });
  watch.check();
  for (const Optimum& o : optima)
    result.starts.push_back({o.error, -1, o.iterations});
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    result.starts[chosen[i]].refined_error = refined[i].error;
    result.starts[chosen[i]].iterations += refined[i].iterations;
  }
  const auto best = std::min_element(refined.begin(), refined.end(),
                                     [](const auto& a, const auto& b) { return a.error < b.error; });
  if (!std::isfinite(best->error))
    throw Error(fmt::format("{}: no start led to finite values", options.model));
  result.best_start = int(chosen[std::size_t(best - refined.begin())]);
  result.iterations = result.starts[std::size_t(result.best_start)].iterations;

  const auto all_nodes = grids.get(measured, every);
  const bool polish = options.every_node && all_nodes->count > fine_nodes->count;
  const Residuals on_all(polish ? *all_nodes : *fine_nodes, options.metric, layout, result.loss,
                         options.channel);
  const int last_steps = std::min(options.max_iterations, 30);
  watch.begin_stage(1, 0.9, 1);
  const Optimum last = options.every_node ? newton(on_all, best->coordinates, last_steps, 3e-10,
                                                   polish ? on_fine : on_all, watch.on_step())
                                          : *best;
  watch.check();
  const std::vector<double> x = sorted_lobes(layout, last.coordinates);
  result.iterations += last.iterations;
  result.material = layout.material(x);
  result.material.name = options.model;
  result.parameters = describe(on_all, x, options.confidence);
  result.metric = options.metric;
  result.errors = metric_errors(*all_nodes, result.material);
  result.fit_error = last.error;
  result.nodes = fine_nodes->count;
  result.theta_d_step = fine.theta_d_step;
  result.phi_d_step = fine.phi_d_step;
  result.max_theta_deg = options.max_theta_deg;
  result.isotropic = options.isotropic;
  result.channel = options.channel;
  result.confidence = options.confidence;
  result.converged = last.converged;
  result.message = last.converged ? "a further step would not lower the error"
                   : last.iterations == last_steps
                       ? "the limit of iterations was reached"
                       : "no step lowers the error, though the slope does not vanish";
  if (options.images || !options.environment.empty())
    result.images =
        image_errors(measured, result.material,
                     options.environment.empty() ? studio_lights() : environment_lights(options.environment),
                     48, options.max_theta_deg);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return result;
}

} // namespace nacre
