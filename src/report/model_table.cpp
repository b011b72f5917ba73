#include "report/model_table.h"

#include "core/random.h"
#include "core/statistics.h"
#include "core/warp.h"
#include "validate/validate.h"

#include <ctime>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr std::size_t pairs = 1024; // in the first-level cache

double uniform_number(std::size_t i, int d) {
  return unit_double(hash(std::uint64_t(11), i, std::uint64_t(d)));
}

/// Directions on the upper hemisphere, half of the light near the mirror direction; for what transmits a
/// quarter from below.
std::pair<Vec3d, Vec3d> pair(std::size_t i, bool transmits) {
  const auto u = [&](int d) { return uniform_number(i, d); };
  const Vec3d wo = square_to_cosine_hemisphere(Vec2<double>{u(0), u(1)});
  Vec3d wi = square_to_cosine_hemisphere(Vec2<double>{u(2), u(3)});
  if (i % 2) wi = normalize(Vec3d{-wo.x, -wo.y, wo.z} + 0.3 * wi);
  if (transmits && i % 4 == 0) wi.z = -wi.z;
  return {wo, wi};
}

/// Calls of f(i), i below `count`, in a second: the best of several rounds of 10 ms.
template <class F>
double rate(std::size_t count, F f) {
  double best = 0;
  for (int round = 0; round < 4; ++round) {
    std::size_t calls = 0;
    const double start = cpu_seconds();
    double seconds = 0;
    do {
      for (int repeat = 0; repeat < 4; ++repeat) // to ask for the time seldom
        for (std::size_t i = 0; i < count; ++i)
          f(i);
      calls += 4 * count;
      seconds = cpu_seconds() - start;
    } while (seconds < 0.01);
    best = std::max(best, double(calls) / seconds);
  }
  return best;
}

} // namespace

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double sampling_variance(const MaterialSpec& material, double theta_rad, int samples) {
  const auto bsdf = make_bsdf<double>(material);
  const Vec3d wo = spherical_direction(theta_rad, 0.4);
  RunningMoments weight;
  for (std::size_t i = 0; i < std::size_t(samples); ++i) {
    const auto u = [&](int d) { return uniform_number(i, 10 + d); };
    const auto s = bsdf.sample(wo, u(0), {u(1), u(2)});
    weight.add(s.pdf > 0 ? average(s.f) * std::abs(s.wi.z) / s.pdf : 0);
  }
  return weight.mean() > 0 ? weight.variance() / sqr(weight.mean()) : 0;
}

ModelMeasurement measure(const ModelInfo& model) {
  ModelMeasurement row{&model, {}, 0, 0, 0, 0, 0};
  const MaterialSpec material = parse_material(model.name);
  ValidateOptions options;
  options.samples = 20000;
  options.directions = 4000;
  options.significance = 1e-4;
  for (const LawResult& law : validate(material, options).laws)
    if (law.verdict == Verdict::violated) row.violated.push_back(law.law);

  const int index = model_index(model.name);
  std::vector<float> values;
  for (const ParameterInfo& p : model.parameters)
    values.insert(values.end(), p.per_channel ? 4 : 1, float(p.initial));
  const BsdfLobe<float, 4> scalar(index, values);
  const auto packed = make_bsdf<Pack>(material);
  std::vector<Vec3f> wo, wi;
  std::array<std::vector<float>, 6> w;
  for (std::size_t i = 0; i < pairs; ++i) {
    const auto [o, n] = pair(i, model.laws.transmits);
    wo.push_back(vec3<float>(o)), wi.push_back(vec3<float>(n));
    const double xyz[] = {o.x, o.y, o.z, n.x, n.y, n.z};
    for (std::size_t k = 0; k < 6; ++k)
      w[k].push_back(float(xyz[k]));
  }
  float sum = 0; // so that nothing is optimised away
  row.float_rate = rate(pairs, [&](std::size_t i) { sum += scalar.eval(wo[i], wi[i])[0]; });
  row.pdf_rate = rate(pairs, [&](std::size_t i) { sum += scalar.pdf(wo[i], wi[i]); });
  row.sample_rate = rate(pairs, [&](std::size_t i) {
    sum += scalar.sample(wo[i], w[0][i] * 0.5f + 0.5f, {w[3][i] * 0.5f + 0.5f, w[4][i] * 0.5f + 0.5f}).pdf;
  });
  Pack packed_sum(0.0f);
  row.pack_rate = double(pack_width) * rate(pairs / pack_width, [&](std::size_t i) {
                    const auto at = [&](std::size_t k) { return load(&w[k][i * pack_width]); };
                    packed_sum += packed.eval({at(0), at(1), at(2)}, {at(3), at(4), at(5)})[0];
                  });
  [[maybe_unused]] static volatile float sink;
  sink = sum + lane(packed_sum, 0);
  for (const double theta : {0.0, 30.0, 60.0, 80.0})
    row.sampling_variance = std::max(row.sampling_variance, sampling_variance(material, theta * pi / 180));
  return row;
}

std::string model_table_markdown(const std::vector<ModelMeasurement>& rows) {
  std::string text = R"(# Models: laws, speed, sampling

<!-- Written by `nacre materials --measure`; `./nacre figures` writes it anew. -->

Every model of the list at its default parameters. [models.md](models.md) describes them and shows pictures.

- *Laws*: what `nacre validate` finds broken at the defaults; in italics what the model declares of its whole domain.
- *Evaluations*: millions a second on one core, directions in the first-level cache; `float` at four wavelengths, as
  the renderer calls it, and packs of 16 (AVX-512; 8 with AVX2) in RGB. Compilers put the four wavelengths side by
  side in a register; the ratio of one direction against a pack, RGB both, is what `./nacre bench
  --benchmark_filter=eval/` measures.
- *Sample*: `sample` with its f and pdf, float, millions a second.
- *Variance*: of f cos / pdf, relative to the square of its mean, the largest of 0, 30, 60 and 80 degrees: what one
  sample of the model adds under uniform light. 0 is perfect; 1 is as noisy as the mean is bright.

| model | paper | parameters | laws | eval, float | eval, packs | sample | variance |
|---|---|---|---|---:|---:|---:|---:|
)";
  const auto millions = [](double r) {
    return r >= 1e7 ? fmt::format("{:.0f}", r / 1e6) : fmt::format("{:.2g}", r / 1e6);
  };
  for (const ModelMeasurement& row : rows) {
    std::string laws;
    for (const std::string& law : row.violated)
      laws += (laws.empty() ? "breaks: " : ", ") + law;
    if (laws.empty()) laws = "keeps all";
    const Laws& claims = row.model->laws;
    if (!claims.reciprocal) laws += "; *not reciprocal*";
    if (std::isinf(claims.energy_gain))
      laws += "; *gain without bound*";
    else if (claims.energy_gain >= 1)
      laws += fmt::format("; *albedo up to {:.2g}*", 1 + claims.energy_gain);
    else if (claims.energy_gain > 0)
      laws += fmt::format("; *gain up to {:.2g} %*", 100 * claims.energy_gain);
    if (claims.stochastic) laws += "; *estimates*";
    std::string parameters;
    for (const ParameterInfo& p : row.model->parameters)
      parameters += (parameters.empty() ? "" : ", ") + p.name;
    const double variance = row.sampling_variance < 1e-12 ? 0 : row.sampling_variance; // rounding
    text += fmt::format("| [`{0}`](models.md#{0}) | {1} | {2} | {3} | {4} | {5} | {6} | {7:.2g} |\n",
                        row.model->name, row.model->source, parameters, laws, millions(row.float_rate),
                        millions(row.pack_rate), millions(row.sample_rate), variance);
  }
  return text;
}

} // namespace nacre
