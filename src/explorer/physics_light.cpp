// Topics of light at a plane surface and of radiometry.
#include "explorer/physics_topics.h"
#include "optics/fresnel_amplitudes.h"
#include "report/material_images.h"
#include "report/material_plots.h"
#include "spectra/ior.h"
#include "spectra/named_ior.h"

#include <limits>

namespace nacre {
namespace {

constexpr double degrees = 180 / pi, nan = std::numeric_limits<double>::quiet_NaN();

double refracted(double theta_i, double eta) {
  const double s = std::sin(theta_i) / eta;
  return s <= 1 ? std::asin(s) : nan;
}

PolarizedReflectance<double> reflectance(double theta, double eta, double k) {
  return fresnel_amplitudes(std::max(std::cos(theta), 0.0), eta, k).reflectance();
}

Answer snell(const Arguments& a, const Desk&) {
  const double eta_i = a.number("eta_i", 1, 0.1, 10), eta_t = a.number("eta_t", 1.5, 0.1, 10);
  const double theta_i = a.angle("theta_i", 45, 0, 90) / degrees, eta = eta_t / eta_i;
  CurveAnswer answer("θi / degrees", "θt / degrees", {"θt"});
  for (int i = 0; i <= 360; ++i)
    answer.add(i / 4.0, {refracted(i / 4.0 / degrees, eta) * degrees});
  answer.value("theta_t", refracted(theta_i, eta) * degrees);
  answer.value("critical", eta < 1 ? std::asin(eta) * degrees : nan);
  answer.value("brewster", std::atan(eta) * degrees);
  answer.value("reflectance", reflectance(theta_i, eta, 0).unpolarized());
  return answer.finish();
}

Answer fresnel(const Arguments& a, const Desk&) {
  const std::string metal = a.text("metal", "");
  const double theta_i = a.angle("theta_i", 45, 0, 90) / degrees;
  double eta = a.number("eta", 1.5, 0.1, 10), k = 0;
  std::array<double, 3> etas{eta, eta, eta}, ks{};
  std::vector<float> spectrum;
  constexpr int bands = 95;
  constexpr double from = 360, step = 5, middle = 550;
  const ConductorIor* ior = metal.empty() ? nullptr : find_metal(metal);
  if (!metal.empty() && !ior)
    throw Error(fmt::format("no metal '{}'{}", metal, suggestion(metal, metal_names())));
  if (ior) {
    const auto rgb = metal_rgb(metal);
    for (std::size_t c = 0; rgb && c < 3; ++c)
      etas[c] = rgb->eta[c], ks[c] = rgb->k[c];
    eta = double(ior->eta.eval(float(middle))), k = double(ior->k.eval(float(middle)));
  }
  const auto at = [&](double nm) {
    return ior ? std::array{double(ior->eta.eval(float(nm))), double(ior->k.eval(float(nm)))}
               : std::array{eta, k};
  };
  CurveAnswer answer("θi / degrees", "reflectance", {"R_s", "R_p", "R"});
  double lowest = 2, lowest_at = 0;
  for (int i = 0; i <= 360; ++i) {
    const auto r = reflectance(i / 4.0 / degrees, eta, k);
    answer.add(i / 4.0, {r.s, r.p, r.unpolarized()});
    if (r.p < lowest) lowest = r.p, lowest_at = i / 4.0;
  }
  for (int row = 0; row < 4; ++row)
    for (int i = 0; i < bands; ++i) {
      const double nm = from + step * i;
      const auto [n, kappa] = at(nm);
      spectrum.push_back(float(row == 0   ? nm
                               : row == 1 ? n
                               : row == 2 ? kappa
                                          : reflectance(theta_i, n, kappa).unpolarized()));
    }
  answer.array("spectrum", {4, bands}, std::move(spectrum));
  for (const auto& [name, c] : {std::pair{"r", 0}, {"g", 1}, {"b", 2}})
    answer.value(name, reflectance(theta_i, etas[std::size_t(c)], ks[std::size_t(c)]).unpolarized());
  answer.value("pseudo_brewster", lowest_at);
  answer.header()["metals"] = metal_names();
  if (ior) answer.header()["data_source"] = ior->source;
  return answer.finish();
}

Answer lambert(const Arguments& a, const Desk&) {
  const double reflectance = a.number("reflectance", 0.5, 0, 1), theta = a.angle("theta_i", 45, 0, 90);
  CurveAnswer answer("θi / degrees", "of a light of irradiance 1 at normal incidence",
                     {"irradiance", "radiance"});
  const auto irradiance = [](double deg) { return std::cos(std::min(deg, 90.0) / degrees); };
  for (int i = 0; i <= 180; ++i)
    answer.add(i / 2.0, {irradiance(i / 2.0), reflectance * inv_pi * irradiance(i / 2.0)});
  answer.value("irradiance", irradiance(theta));
  answer.value("radiance", reflectance * inv_pi * irradiance(theta));
  return answer.finish();
}

/// Irradiance under the middle of a disk of radiance 1 that faces the surface: pi sin^2 of its half angle.
double under_disk(double distance, double radius) { return pi * sqr(radius) / (sqr(radius) + sqr(distance)); }

Answer inverse_square(const Arguments& a, const Desk&) {
  const double distance = a.number("distance", 2, 1e-3, 1e6), radius = a.number("radius", 0.5, 1e-6, 1e6);
  const double cosine = std::cos(a.angle("theta_i", 0, 0, 90) / degrees);
  // The point is as strong as the disk is from afar: intensity pi radius^2.
  const auto point = [&](double d) { return pi * sqr(radius) / sqr(d) * cosine; };
  const auto disk = [&](double d) { return under_disk(d, radius) * cosine; };
  CurveAnswer answer("distance", "irradiance of a light of radiance 1", {"point", "disk"});
  for (int i = 1; i <= 300; ++i) {
    const double d = std::max(3 * distance, 6 * radius) * i / 300;
    answer.add(d, {point(d), disk(d)});
  }
  answer.value("point", point(distance));
  answer.value("disk", disk(distance));
  return answer.finish();
}

Answer solid_angle(const Arguments& a, const Desk&) {
  const double half = a.angle("half_angle", 30, 0, 90);
  const auto solid = [](double deg) { return 4 * pi * sqr(std::sin(deg / 2 / degrees)); };
  const auto projected = [](double deg) { return pi * sqr(std::sin(deg / degrees)); };
  CurveAnswer answer("half angle of the cone / degrees", "sr", {"solid angle", "projected"});
  for (int i = 0; i <= 180; ++i)
    answer.add(i / 2.0, {solid(i / 2.0), projected(i / 2.0)});
  answer.value("solid_angle", solid(half));
  answer.value("projected", projected(half));
  return answer.finish();
}

Answer radiance(const Arguments& a, const Desk&) {
  const double radius = a.number("radius", 0.5, 1e-6, 1e6), distance = a.number("distance", 2, 1e-3, 1e6);
  const double cosine = std::cos(a.angle("theta_i", 0, 0, 90) / degrees);
  const auto solid = [&](double d) { return 2 * pi * (1 - d / std::hypot(d, radius)); };
  CurveAnswer answer("distance", "of a disk of radiance 1", {"radiance", "solid angle", "irradiance"});
  for (int i = 1; i <= 300; ++i) {
    const double d = std::max(3 * distance, 6 * radius) * i / 300;
    answer.add(d, {1, solid(d), under_disk(d, radius) * cosine});
  }
  answer.value("radiance", 1);
  answer.value("solid_angle", solid(distance));
  answer.value("irradiance", under_disk(distance, radius) * cosine);
  return answer.finish();
}

Answer furnace(const Arguments& a, const Desk& desk) {
  const auto material = desk.materials.resolve(a.at("material"), desk.folder);
  CurveAnswer answer("θo / degrees", "albedo", {"R", "G", "B"});
  for (int i = 0; i <= 44; ++i) {
    const double theta = std::min(2.0 * i, 89.0);
    const auto albedo = sampled_albedo(*material, theta / degrees, 1024);
    answer.add(theta, {albedo[0], albedo[1], albedo[2]});
  }
  const int size = a.whole("size", 128, 8, 1024);
  const Image image = furnace_sphere(*material, size);
  answer.array("image", {std::size_t(size), std::size_t(size), 3}, image.data);
  return answer.finish();
}

} // namespace

CurveAnswer::CurveAnswer(std::string x_label, std::string y_label, std::vector<std::string> series)
    : series_(series.size()), y_(series.size()) {
  answer_.header = {{"x_label", std::move(x_label)},
                    {"y_label", std::move(y_label)},
                    {"series", std::move(series)},
                    {"values", nlohmann::json::object()}};
}
void CurveAnswer::add(double x, std::initializer_list<double> y) {
  x_.push_back(float(x));
  std::size_t s = 0;
  for (const double v : y)
    y_[s++].push_back(float(v));
}
void CurveAnswer::value(const char* name, double x) {
  answer_.header["values"][name] = std::isfinite(x) ? nlohmann::json(x) : nlohmann::json();
}
void CurveAnswer::array(std::string name, std::vector<std::size_t> shape, std::vector<float> data) {
  answer_.add(std::move(name), std::move(shape), std::move(data));
}
Answer CurveAnswer::finish() {
  const std::size_t n = x_.size();
  std::vector<float> y;
  for (const auto& series : y_)
    y.insert(y.end(), series.begin(), series.end());
  answer_.add("x", {n}, std::move(x_));
  answer_.add("y", {series_, n}, std::move(y));
  return std::move(answer_);
}

const std::vector<PhysicsTopic>& physics_topics() {
  static const std::vector<PhysicsTopic> topics{
      {"snell", "η_i sin θ_i = η_t sin θ_t;  sin θ_c = η_t / η_i;  tan θ_B = η_t / η_i",
       "Born and Wolf, Principles of Optics, section 1.5", snell},
      {"fresnel",
       "r_s = (cos θ_i − q) / (cos θ_i + q),  r_p = (n² cos θ_i − q) / (n² cos θ_i + q),  q = √(n² − sin² "
       "θ_i),  n = η + iκ,  "
       "R = (|r_s|² + |r_p|²) / 2",
       "Born and Wolf, Principles of Optics, eqs. 1.5.20 and 1.5.21", fresnel},
      {"lambert", "E = E_⊥ cos θ_i;  L_o = (ρ / π) E", "Lambert 1760, Photometria", lambert},
      {"inverse_square", "point: E = I cos θ / d²;  disk: E = π L r² cos θ / (d² + r²) under its middle",
       "Lambert 1760, Photometria", inverse_square},
      {"solid_angle", "Ω = 2π (1 − cos α);  Ω_⊥ = ∫ cos θ dω = π sin² α",
       "Nicodemus et al. 1977, Geometrical Considerations and Nomenclature for Reflectance", solid_angle},
      {"radiance", "L = d²Φ / (dA cos θ dω): along a ray it stays; E = ∫ L cos θ dω",
       "Nicodemus et al. 1977, Geometrical Considerations and Nomenclature for Reflectance", radiance},
      {"ndf", "∫ D(ω_m) cos θ_m dω_m = 1", "Heitz 2014, eq. 4; Walter et al. 2007, eqs. 25 and 33",
       answer_ndf},
      {"visible_normals", "D_v(ω_m) = G1(ω_o) max(0, ω_o · ω_m) D(ω_m) / cos θ_o;  ∫ D_v dω_m = 1",
       "Heitz 2014, eq. 16 and 17", answer_visible_normals},
      {"masking", "G1(ω_o) = 1 / (1 + Λ(ω_o));  V-cavity: min(1, 2 cos θ_m cos θ_o / (ω_o · ω_m))",
       "Smith 1967; Heitz 2014, eq. 43; Torrance and Sparrow 1967", answer_masking},
      {"projected_area", "cos θ_o = ∫ G1(ω_o) max(0, ω_o · ω_m) D(ω_m) dω_m", "Heitz 2014, eq. 14",
       answer_projected_area},
      {"multiple_bounces", "albedo = ∫ f cos θ_i dω_i, of one bounce and of all",
       "Heitz, Hanika, d'Eon, Dachsbacher 2016, Multiple-Scattering Microfacet BSDFs with the Smith Model",
       answer_multiple_bounces},
      {"furnace", "under radiance 1 from everywhere L_o = ∫ f cos θ_i dω_i = albedo, at most 1",
       "Heitz 2014, section 5.2", furnace},
  };
  return topics;
}

} // namespace nacre
