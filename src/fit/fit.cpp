#include "fit/fit.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/sobol.h"
#include "fit/newton.h"
#include "fit/uncertainty.h"
#include "measured/merl_table.h"

#include <ceres/problem.h>
#include <ceres/solver.h>
#include <chrono>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace nacre {
namespace {

struct Optimum {
  std::vector<double> coordinates;
  double error = std::numeric_limits<double>::infinity(); ///< E over the grid
  int iterations = 0;
  bool converged = false;
  std::string message;
};

/// Levenberg and Marquardt's method by Ceres into the neighbourhood of the optimum, Newton's for the rest.
/// @param tolerance  relative change of the cost at which Newton's steps stop
Optimum optimise(const Residuals& residuals, std::vector<double> x, int max_iterations, double tolerance) {
  ceres::Problem::Options keep;
  keep.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(keep);
  const ParameterLayout& layout = residuals.layout();
  problem.AddParameterBlock(x.data(), layout.size());
  for (int i = 0; i < layout.size(); ++i) {
    problem.SetParameterLowerBound(x.data(), i, layout[i].coordinate_lo());
    problem.SetParameterUpperBound(x.data(), i, layout[i].coordinate_hi());
  }
  // Ceres asks for a mutable function and does not change it.
  problem.AddResidualBlock(const_cast<Residuals*>(&residuals), nullptr, x.data());

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY; // some 10^5 rows by ten columns
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-4;
  options.parameter_tolerance = 1e-9;
  options.num_threads = 1; // the starts are what runs in parallel
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  Optimum o;
  o.iterations = int(summary.iterations.size()) - 1;
  o.message = summary.message;
  if (!summary.IsSolutionUsable()) return o;
  NewtonResult newton = newton_inside_bounds(residuals, std::move(x), max_iterations, tolerance);
  o.iterations += newton.iterations;
  o.coordinates = std::move(newton.coordinates);
  o.error = std::sqrt(2 * newton.cost);
  o.converged = newton.converged;
  o.message = newton.converged ? "a further step would not lower the error"
              : newton.iterations == max_iterations
                  ? "the limit of iterations was reached"
                  : "no step lowers the error, though the slope does not vanish";
  return o;
}

bool at_bound(const FreeParameter& p, double coordinate) {
  const double lo = p.coordinate_lo(), hi = p.coordinate_hi();
  return std::min(coordinate - lo, hi - coordinate) < 1e-6 * (hi - lo);
}

/// The optimum, not stopped by a bound where the slope vanishes: a metal's reflectance depends on the square
/// of its absorption k, so a step that was cut off at k = 0 never leaves again. What ended at a bound is put
/// a tenth of its range inside and tried once more.
Optimum optimise_off_bounds(const Residuals& residuals, std::vector<double> x, int max_iterations) {
  constexpr double tolerance = 1e-6; // enough to rank optima: the best go on
  Optimum first = optimise(residuals, std::move(x), max_iterations, tolerance);
  if (first.coordinates.empty()) return first;
  std::vector<double> inside = first.coordinates;
  const ParameterLayout& layout = residuals.layout();
  for (int i = 0; i < layout.size(); ++i) {
    double& c = inside[std::size_t(i)];
    const double lo = layout[i].coordinate_lo(), hi = layout[i].coordinate_hi();
    if (at_bound(layout[i], c)) c = c - lo < hi - c ? lo + 0.1 * (hi - lo) : hi - 0.1 * (hi - lo);
  }
  if (inside == first.coordinates) return first;
  Optimum second = optimise(residuals, std::move(inside), max_iterations, tolerance);
  const int iterations = first.iterations + second.iterations;
  Optimum& better = second.error < first.error ? second : first;
  better.iterations = iterations;
  return std::move(better);
}

/// Start 0 is the material as given; the others are stratified over the box of coordinates, the channels of a
/// colour starting grey.
std::vector<double> starting_point(const ParameterLayout& layout, std::uint64_t seed, int start) {
  std::vector<double> x = layout.coordinates(layout.start());
  if (start == 0) return x;
  SobolSampler sampler(seed, 0, std::uint32_t(start - 1));
  double u = 0;
  for (int i = 0; i < layout.size(); ++i) {
    if (layout[i].channel <= 0) u = sampler.next_1d();
    x[std::size_t(i)] =
        layout[i].coordinate_lo() + u * (layout[i].coordinate_hi() - layout[i].coordinate_lo());
  }
  return x;
}

void check(const FitOptions& o) {
  if (o.starts < 1 || o.starts > 100000)
    throw Error(fmt::format("a fit has 1 to 100000 starts, found {}", o.starts));
  if (o.refined < 1) throw Error(fmt::format("a fit refines at least 1 start, found {}", o.refined));
  if (o.max_iterations < 1)
    throw Error(fmt::format("a fit takes at least 1 iteration, found {}", o.max_iterations));
  if (o.theta_d_step < 0 || o.phi_d_step < 0)
    throw Error(fmt::format("steps between the nodes of a fit are not negative, found {}, {}", o.theta_d_step,
                            o.phi_d_step));
}

Observations observe_enough(const MeasuredBsdf& measured, const NodeSelection& selection, int parameters) {
  Observations o = observe(measured, selection);
  if (o.count <= std::size_t(parameters))
    throw Error(
        fmt::format("{} parameters cannot be fitted to {} measured values with both angles below {} degrees",
                    parameters, o.count, selection.max_theta_deg));
  return o;
}

/// Positions of the best distinct optima: of those with the same error the first.
std::vector<std::size_t> best_of(const std::vector<Optimum>& optima, int count) {
  std::vector<std::size_t> order(optima.size()), best;
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return optima[a].error < optima[b].error; });
  for (const std::size_t i : order) {
    if (!std::isfinite(optima[i].error) || best.size() == std::size_t(count)) break;
    if (best.empty() || optima[i].error > optima[best.back()].error * (1 + 1e-3)) best.push_back(i);
  }
  return best;
}

std::vector<FittedParameter> describe(const Residuals& residuals, std::size_t rows,
                                      const std::vector<double>& x) {
  const ParameterLayout& layout = residuals.layout();
  std::vector<double> r(rows), jacobian(rows * x.size());
  const double* parameters = x.data();
  double* jacobians = jacobian.data();
  residuals.Evaluate(&parameters, r.data(), &jacobians);
  std::vector<bool> held;
  for (int i = 0; i < layout.size(); ++i) {
    held.push_back(at_bound(layout[i], x[std::size_t(i)]));
  }
  const Uncertainty u = estimate_uncertainty(r, jacobian, held);
  std::vector<FittedParameter> parameters_out;
  for (int i = 0; i < layout.size(); ++i) {
    const FreeParameter& p = layout[i];
    const std::size_t k = std::size_t(i);
    const ModelInfo& model = model_infos()[std::size_t(layout.start().lobes[std::size_t(p.lobe)].model)];
    const ParameterInfo& info = model.parameters[std::size_t(p.parameter)];
    const double slope = p.slope(x[k]);
    // An error bar as wide as half the domain is none.
    const bool identifiable = u.identifiable[k] && !(slope * u.standard_error[k] > 0.5 * (p.hi - p.lo));
    parameters_out.push_back({layout.label(i), model.name, info.name, info.unit, p.lobe, p.channel,
                              p.value(x[k]), p.lo, p.hi, slope * u.standard_error[k],
                              slope * u.uniform_noise_error[k], held[k], identifiable,
                              u.partner[k] < 0 ? "" : layout.label(u.partner[k]), u.correlation[k],
                              p.tied < 0 ? "" : model.parameters[std::size_t(p.tied)].name});
  }
  return parameters_out;
}

} // namespace

FitResult fit(const MeasuredBsdf& measured, const FitOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  check(options);
  const ParameterLayout layout(parse_material(options.model), options.isotropic);
  NodeSelection fine;
  if (const auto* table = dynamic_cast<const MerlTable*>(&measured)) {
    fine.theta_d_step =
        options.theta_d_step > 0 ? options.theta_d_step : std::max(1, table->n_theta_d() / 30);
    fine.phi_d_step = options.phi_d_step > 0 ? options.phi_d_step : std::max(1, table->n_phi_d() / 30);
  } else {
    constexpr std::size_t enough = 60000; // as many as of a MERL table
    fine.sample_step = int((measured.samples().size() + enough - 1) / enough);
    fine.sample_step = std::max(fine.sample_step, 1);
  }
  fine.max_theta_deg = options.max_theta_deg;
  fine.turned = !options.isotropic;
  NodeSelection coarse = fine;
  coarse.theta_h_step = 2;
  coarse.theta_d_step *= 3;
  coarse.phi_d_step *= 3;
  coarse.sample_step *= 17; // a prime: in step with no axis of a grid

  const Observations fine_nodes = observe_enough(measured, fine, layout.size());
  Observations coarse_nodes = observe(measured, coarse);
  if (coarse_nodes.count < 20 * std::size_t(layout.size())) coarse_nodes = fine_nodes; // a small table
  const Residuals on_fine(fine_nodes, options.metric, layout),
      on_coarse(coarse_nodes, options.metric, layout);
  if (const auto lobe = on_coarse.invisible_lobe(layout.coordinates(layout.start())))
    throw Error(
        fmt::format("{} reflects into the mirror direction alone, which no table holds: it cannot be fitted",
                    model_infos()[std::size_t(layout.start().lobes[std::size_t(*lobe)].model)].name));

  std::vector<Optimum> optima(std::size_t(options.starts));
  parallel_for(optima.size(), [&](std::size_t i) {
    if (stop_requested()) return;
    optima[i] =
        optimise_off_bounds(on_coarse, starting_point(layout, options.seed, int(i)), options.max_iterations);
  });
  const std::vector<std::size_t> chosen = best_of(optima, options.refined);
  std::vector<Optimum> refined(chosen.size());
  parallel_for(chosen.size(), [&](std::size_t i) {
    if (stop_requested()) return;
    refined[i] = optimise(on_fine, optima[chosen[i]].coordinates, options.max_iterations, 1e-10);
  });
  if (stop_requested()) throw Error("the fit was stopped");
  const auto best = std::min_element(refined.begin(), refined.end(),
                                     [](const auto& a, const auto& b) { return a.error < b.error; });
  if (best == refined.end() || !std::isfinite(best->error))
    throw Error(fmt::format("{}: no start led to finite values (last message: {})", options.model,
                            optima.front().message));

  FitResult result;
  for (const Optimum& o : optima)
    result.starts.push_back({o.error, -1, o.iterations});
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    result.starts[chosen[i]].refined_error = refined[i].error;
    result.starts[chosen[i]].iterations += refined[i].iterations;
  }
  result.best_start = int(chosen[std::size_t(best - refined.begin())]);
  result.material = layout.material(best->coordinates);
  result.material.name = options.model;
  result.parameters = describe(on_fine, 3 * fine_nodes.count, best->coordinates);
  result.metric = options.metric;
  result.errors = metric_errors(measured, result.material, options.max_theta_deg);
  result.fit_error = best->error;
  result.nodes = fine_nodes.count;
  result.theta_d_step = fine.theta_d_step;
  result.phi_d_step = fine.phi_d_step;
  result.max_theta_deg = options.max_theta_deg;
  result.isotropic = options.isotropic;
  result.iterations = result.starts[std::size_t(result.best_start)].iterations;
  result.converged = best->converged;
  result.message = best->message;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return result;
}

} // namespace nacre
