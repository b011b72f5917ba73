#include "measured/formats/rgl_bsdf.h"

#include "core/error.h"
#include "core/warp.h"
#include "measured/tensor_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <tuple>

namespace nacre {
namespace {

/// Share of the samples that a cosine lobe gets.
constexpr double cosine_share = 1.0 / 16;
/// Below it the horizon's 0 / 0 of f = (f cos) / cos is not divided out any more.
constexpr double smallest_cosine = 1e-6, smallest_sigma = 1e-9;
/// Keeps every f in range for float: 1e12 1e12 / (4 1e-9 1e-6).
constexpr float largest_entry = 1e12f;

double polar_angle(const Vec3d& w) { return std::atan2(std::sqrt(w.x * w.x + w.y * w.y), w.z); }
double to_u(double theta) { return std::sqrt(std::max(theta, 0.0) * 2 / pi); }
double to_v(double phi) {
  const double v = phi / (2 * pi) + 0.5;
  return v - std::floor(v);
}
/// Solid angle of half vectors a unit of the (u, v) square.
double solid_angle_per_chart(double u, double sin_theta) {
  return std::max(2 * pi * pi * u * sin_theta, 1e-12); // 0 at the pole, where no sample falls
}

int reduction_of(std::span<const float> phi_i) {
  return int(std::lround(2 * pi / (double(phi_i.back()) - double(phi_i.front()))));
}

void check(bool holds, const char* what) {
  if (!holds) throw Error(fmt::format("adaptive reflectance tables: {}", what));
}
bool ascends(std::span<const float> x, float low, float high) {
  return !x.empty() && x.front() >= low && x.back() <= high &&
         std::adjacent_find(x.begin(), x.end(), std::greater_equal<>()) == x.end();
}

} // namespace

RglBsdf::RglBsdf(RglTables t)
    : description_(std::move(t.description)), theta_i_(std::move(t.theta_i)), phi_i_(std::move(t.phi_i)),
      channels_(t.wavelengths_nm.empty() ? Channels::rgb() : Channels::spectral(std::move(t.wavelengths_nm))),
      isotropic_(phi_i_.size() <= 2), jacobian_(t.jacobian), ndf_(std::move(t.ndf)),
      sigma_(std::move(t.sigma)), vndf_(t.vndf_width, t.vndf_height, t.vndf) {
  check(ascends(theta_i_, 0, 1.5708f), "theta_i ascends within [0, pi/2]");
  check(ascends(phi_i_, -6.2832f, 6.2832f), "phi_i ascends within [-2 pi, 2 pi]");
  if (!isotropic_) reduction_ = reduction_of(phi_i_);
  check(reduction_ == 1 || reduction_ == 2 || reduction_ == 4, "phi_i spans a turn, a half or a quarter");
  const std::size_t slices = theta_i_.size() * phi_i_.size(), slice = t.width * t.height;
  const auto channel_count = std::size_t(channels_.count());
  check(t.vndf.size() == slices * t.vndf_width * t.vndf_height && t.luminance.size() == slices * slice &&
            t.spectra.size() == slices * slice * channel_count,
        "sizes agree");
  for (float& y : t.luminance) // noise; of sampling alone
    y = std::max(y, 0.0f);
  luminance_ = MarginalWarp(t.width, t.height, t.luminance);
  spectra_.resize(t.spectra.size());
  for (std::size_t s = 0; s < slices; ++s)
    for (std::size_t c = 0; c < channel_count; ++c)
      for (std::size_t i = 0; i < slice; ++i)
        spectra_[(s * slice + i) * channel_count + c] = t.spectra[(s * channel_count + c) * slice + i];
}

std::string RglBsdf::kind() const {
  return fmt::format("{} reflectance in the adaptive parameterisation (RGL), {}",
                     isotropic_ ? "isotropic" : "anisotropic", channels_.is_spectral() ? "spectral" : "RGB");
}

std::vector<std::pair<std::string, std::string>> RglBsdf::facts() const {
  std::vector<std::pair<std::string, std::string>> facts;
  if (!description_.empty()) facts.emplace_back("description", description_);
  facts.emplace_back("resolution",
                     fmt::format("theta_o {} (to {:.1f} degrees), phi_o {}, {} x {} adapted directions of wi",
                                 theta_i_.size(), double(theta_i_.back()) * 180 / pi, phi_i_.size(),
                                 luminance_.height(), luminance_.width()));
  if (channels_.is_spectral())
    facts.emplace_back("wavelengths",
                       fmt::format("{} from {} to {} nm", channels_.count(),
                                   channels_.wavelengths_nm().front(), channels_.wavelengths_nm().back()));
  facts.emplace_back("microfacets", fmt::format("distribution of {} x {}, visible ones of {} x {}",
                                                ndf_.height, ndf_.width, vndf_.height(), vndf_.width()));
  if (reduction_ > 1)
    facts.emplace_back("symmetry", reduction_ == 2 ? "the same after half a turn" : "mirrored about x and y");
  return facts;
}

RglBsdf::Known RglBsdf::known(const Vec3d& wo) const {
  Known o{wo, 1, 1, polar_angle(wo), 0, {}};
  if (reduction_ >= 2) {
    o.flip_y = wo.y > 0 ? -1 : 1;
    o.flip_x = reduction_ == 4 ? (wo.x > 0 ? -1 : 1) : o.flip_y;
    o.w = {wo.x * o.flip_x, wo.y * o.flip_y, wo.z};
  }
  if (!isotropic_) o.phi = std::atan2(o.w.y, o.w.x);
  o.blend = blend_slices(phi_i_, o.phi, theta_i_, o.theta);
  return o;
}

/// (u, v) of a half vector of any length.
Vec2d RglBsdf::chart(const Known& o, const Vec3d& wm) const {
  double phi;
  if (isotropic_) { // from the azimuth of wo
    const bool on_normal = o.w.x == 0 && o.w.y == 0;
    const double x = on_normal ? 1 : o.w.x, y = o.w.y;
    phi = std::atan2(x * wm.y - y * wm.x, x * wm.x + y * wm.y);
  } else {
    phi = std::atan2(wm.y, wm.x);
  }
  return {to_u(polar_angle(wm)), to_v(phi)};
}

double RglBsdf::scale(const Known& o, const Vec2d& u_m, double cos_i) const {
  const double inverse = 1 / std::max(cos_i, smallest_cosine);
  if (!jacobian_) return inverse;
  const double sigma = sigma_.at({to_u(o.theta), to_v(o.phi)});
  return sigma > smallest_sigma ? ndf_.at(u_m) / (4 * sigma) * inverse : 0;
}

/// Calls f(values of all channels, weight) for the nodes about s.
template <class F>
void RglBsdf::for_each_node(const Vec2d& s, const SliceBlend& blend, F f) const {
  const std::size_t w = luminance_.width(), h = luminance_.height(), n = std::size_t(channels_.count());
  const BilinearCell c(s, w, h);
  for (std::size_t k = 0; k < blend.count; ++k) {
    const float* corner = &spectra_[((blend.slice[k] * h + c.y) * w + c.x) * n];
    const double low = blend.weight[k] * (1 - c.fy), high = blend.weight[k] * c.fy;
    f(corner, float(low * (1 - c.fx)));
    f(corner + n, float(low * c.fx));
    f(corner + w * n, float(high * (1 - c.fx)));
    f(corner + (w + 1) * n, float(high * c.fx));
  }
}

bool RglBsdf::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  std::fill(f.begin(), f.end(), 0.0f);
  if (!(wo.z > 0 && wi.z > 0)) return false;
  const Known o = known(wo);
  const Vec3d i{wi.x * o.flip_x, wi.y * o.flip_y, wi.z};
  const Vec2d u_m = chart(o, o.w + i), s = vndf_.invert(u_m, o.blend).at;
  const std::size_t n = f.size();
  for_each_node(s, o.blend, [&](const float* node, float weight) {
    for (std::size_t c = 0; c < n; ++c)
      f[c] += weight * node[c];
  });
  const auto factor = float(scale(o, u_m, wi.z));
  bool is_zero = true;
  for (float& x : f) {
    x *= factor;
    if (!channels_.is_spectral()) x = std::max(x, 0.0f);
    is_zero &= x == 0;
  }
  return !is_zero || luminance_.pdf(s, o.blend) > 0;
}

SampledSpectrum RglBsdf::at(const Vec3d& wo, const Vec3d& wi, const Wavelengths& wavelengths) const {
  if (!channels_.is_spectral()) return MeasuredBsdf::at(wo, wi, wavelengths);
  if (!(wo.z > 0 && wi.z > 0)) return SampledSpectrum(0.0f);
  const std::vector<double>& nodes = channels_.wavelengths_nm();
  std::array<std::size_t, 4> below{}, above{};
  std::array<float, 4> fraction{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double x = double(wavelengths.lambda_nm[k]);
    const auto next = std::size_t(std::upper_bound(nodes.begin(), nodes.end(), x) - nodes.begin());
    below[k] = next > 0 ? next - 1 : 0;
    above[k] = std::min(next, nodes.size() - 1);
    if (above[k] > below[k]) fraction[k] = float((x - nodes[below[k]]) / (nodes[above[k]] - nodes[below[k]]));
  }
  const Known o = known(wo);
  const Vec3d i{wi.x * o.flip_x, wi.y * o.flip_y, wi.z};
  const Vec2d u_m = chart(o, o.w + i), s = vndf_.invert(u_m, o.blend).at;
  SampledSpectrum f;
  for_each_node(s, o.blend, [&](const float* node, float weight) {
    for (std::size_t k = 0; k < 4; ++k)
      f.c[k] += weight * (node[below[k]] + fraction[k] * (node[above[k]] - node[below[k]]));
  });
  const auto factor = float(scale(o, u_m, wi.z));
  return f.map([&](float x) { return std::max(x * factor, 0.0f); });
}

double RglBsdf::pdf(const Vec3d& wo, const Vec3d& wi) const {
  if (!(wo.z > 0 && wi.z > 0)) return 0;
  const Known o = known(wo);
  const Vec3d wm = normalize(o.w + Vec3d{wi.x * o.flip_x, wi.y * o.flip_y, wi.z});
  const Vec2d u_m = chart(o, wm);
  const auto warped = vndf_.invert(u_m, o.blend);
  const double sin_m = std::sqrt(wm.x * wm.x + wm.y * wm.y);
  const double own = luminance_.pdf(warped.at, o.blend) * warped.pdf /
                     (solid_angle_per_chart(u_m.x, sin_m) * 4 * dot(o.w, wm));
  return (1 - cosine_share) * own + cosine_share * wi.z * inv_pi;
}

std::pair<Vec3d, double> RglBsdf::direction(const Known& o, const Vec2d& s) const {
  const auto m = vndf_.sample(s, o.blend);
  const double theta = m.at.x * m.at.x * pi / 2;
  double phi = (2 * m.at.y - 1) * pi;
  if (isotropic_) phi += std::atan2(o.w.y, o.w.x);
  const Vec3d wm = spherical_direction(theta, phi);
  const Vec3d wi = reflect(o.w, wm);
  return {{wi.x * o.flip_x, wi.y * o.flip_y, wi.z},
          m.pdf / (solid_angle_per_chart(m.at.x, std::sin(theta)) * 4 * std::max(dot(o.w, wm), 1e-12))};
}

std::pair<Vec3d, double> RglBsdf::direction(const Vec3d& wo, const Vec2d& s) const {
  return direction(known(wo), s);
}

Vec3d RglBsdf::sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const {
  if (!(wo.z > 0)) return {0, 0, -1};
  if (u_lobe < cosine_share) return square_to_cosine_hemisphere(u);
  const Known o = known(wo);
  return direction(o, luminance_.sample(u, o.blend).at).first;
}

MeasuredSamples RglBsdf::samples() const {
  MeasuredSamples samples;
  const std::size_t w = luminance_.width(), h = luminance_.height(), n = std::size_t(channels_.count());
  // Cosines at the midpoints between the angles; the last node reaches as far out as in.
  std::vector<double> edge{1};
  for (std::size_t t = 0; t + 1 < theta_i_.size(); ++t)
    edge.push_back(std::cos(0.5 * (double(theta_i_[t]) + double(theta_i_[t + 1]))));
  const double last = double(theta_i_.back());
  const double outward = theta_i_.size() > 1 ? 0.5 * (last - double(theta_i_[theta_i_.size() - 2])) : pi / 2;
  edge.push_back(std::cos(std::min(last + outward, pi / 2)));
  std::vector<float> f(n);
  for (std::size_t p = 0; p < phi_i_.size(); ++p) {
    const bool end = phi_i_.size() > 2 && (p == 0 || p + 1 == phi_i_.size());
    for (std::size_t t = 0; t < theta_i_.size(); ++t) {
      const Vec3d wo = spherical_direction(double(theta_i_[t]), isotropic_ ? 0.0 : double(phi_i_[p]));
      const double share = (edge[t] - edge[t + 1]) * (end ? 0.5 : 1);
      if (!(wo.z > 0)) continue;
      for (std::size_t y = 0; y < h; ++y)
        for (std::size_t x = 0; x < w; ++x) {
          const Vec2d s{double(x) / double(w - 1), double(y) / double(h - 1)};
          const auto [wi, density] = direction(wo, s);
          if (!(wi.z > 0) || !evaluate(wo, wi, f)) continue;
          samples.wo.push_back(Vec3f{float(wo.x), float(wo.y), float(wo.z)});
          samples.wi.push_back(Vec3f{float(wi.x), float(wi.y), float(wi.z)});
          samples.f.insert(samples.f.end(), f.begin(), f.end());
          const double cell = (x == 0 || x + 1 == w ? 0.5 : 1.0) * (y == 0 || y + 1 == h ? 0.5 : 1.0) /
                              double((w - 1) * (h - 1));
          samples.weight.push_back(density > 0 ? share * cell / density : 0);
        }
    }
    if (isotropic_) break; // a second azimuth says nothing new
  }
  return samples;
}

RglTables RglBsdf::tables() const {
  RglTables t;
  t.description = description_;
  t.theta_i = theta_i_, t.phi_i = phi_i_;
  t.wavelengths_nm = channels_.wavelengths_nm();
  t.ndf = ndf_, t.sigma = sigma_;
  t.vndf_width = vndf_.width(), t.vndf_height = vndf_.height();
  t.vndf.assign(vndf_.densities().begin(), vndf_.densities().end());
  t.width = luminance_.width(), t.height = luminance_.height();
  t.luminance.assign(luminance_.densities().begin(), luminance_.densities().end());
  t.jacobian = jacobian_;
  t.spectra.resize(spectra_.size());
  const std::size_t slice = t.width * t.height, n = t.channel_count();
  for (std::size_t s = 0; s < theta_i_.size() * phi_i_.size(); ++s)
    for (std::size_t c = 0; c < n; ++c)
      for (std::size_t i = 0; i < slice; ++i)
        t.spectra[(s * n + c) * slice + i] = spectra_[(s * slice + i) * n + c];
  return t;
}

namespace {

/// Reads the fields one by one, each judged before the next.
class RglReader {
public:
  RglReader(std::span<const std::uint8_t> bytes, std::string_view name)
      : file_(TensorFile::parse(bytes, name)) {}

  RglTables read() {
    RglTables t;
    t.description = text("description");
    t.theta_i = angles("theta_i", 0, 1.5708f);
    t.phi_i = angles("phi_i", -6.2832f, 6.2832f);
    if (t.phi_i.size() > 2)
      if (const int r = reduction_of(t.phi_i); r != 1 && r != 2 && r != 4)
        file_.fail(*file_.find("phi_i"),
                   fmt::format("spans {} radians, expected a whole turn, a half or a quarter",
                               t.phi_i.back() - t.phi_i.front()));
    const Tensor& jacobian = file_.field("jacobian", TensorType::uint8, 1);
    if (jacobian.bytes.size() != 1) file_.fail(jacobian, "expected one number");
    t.jacobian = jacobian.bytes[0] != 0;
    t.ndf = table("ndf");
    t.sigma = table("sigma");
    const std::uint64_t phis = t.phi_i.size(), thetas = t.theta_i.size();
    std::tie(t.vndf_height, t.vndf_width) = slices("vndf", t.vndf, {phis, thetas});
    check_densities(t);
    std::tie(t.height, t.width) = slices("luminance", t.luminance, {phis, thetas});
    const bool is_rgb = file_.find("rgb") && !file_.find("spectra");
    if (!is_rgb) t.wavelengths_nm = wavelengths();
    const char* values = is_rgb ? "rgb" : "spectra";
    const auto [h, w] = slices(values, t.spectra, {phis, thetas, t.channel_count()});
    if (h != t.height || w != t.width)
      file_.fail(*file_.find(values), fmt::format("slices of {} x {}, but those of luminance are {} x {}", h,
                                                  w, t.height, t.width));
    return t;
  }

private:
  std::string text(std::string_view name) const {
    const Tensor& f = file_.field(name, TensorType::uint8, 1);
    std::string s(f.bytes.begin(), std::find(f.bytes.begin(), f.bytes.end(), 0));
    for (char& c : s)
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    return s;
  }
  std::vector<float> angles(std::string_view name, float low, float high) const {
    std::vector<float> x = file_.floats(name, 1);
    if (!ascends(x, low, high))
      file_.fail(*file_.find(name),
                 fmt::format("expected angles that increase within [{}, {}] radians", low, high));
    return x;
  }
  std::vector<double> wavelengths() const {
    const std::vector<float> x = file_.floats("wavelengths", 1);
    try {
      Channels::spectral({x.begin(), x.end()});
    } catch (const Error& e) {
      file_.fail(*file_.find("wavelengths"), e.what());
    }
    return {x.begin(), x.end()};
  }
  std::vector<float> bounded(std::string_view name, std::size_t dimensions) const {
    std::vector<float> values = file_.floats(name, dimensions);
    for (const float v : values)
      if (!(std::abs(v) <= largest_entry))
        file_.fail(*file_.find(name), fmt::format("holds {}, expected at most {}", v, largest_entry));
    return values;
  }
  BilinearTable table(std::string_view name) const {
    BilinearTable t;
    t.values = bounded(name, 2);
    const Tensor& f = *file_.find(name);
    if (f.shape[0] < 2 || f.shape[1] < 2 || t.values.empty())
      file_.fail(f, fmt::format("expected at least 2 x 2, found {}", to_text(f.shape)));
    if (*std::min_element(t.values.begin(), t.values.end()) < 0) file_.fail(f, "holds a negative number");
    t.height = f.shape[0], t.width = f.shape[1];
    return t;
  }
  /// Height and width of a slice of a table whose first sizes are these.
  std::pair<std::size_t, std::size_t> slices(std::string_view name, std::vector<float>& values,
                                             const std::vector<std::uint64_t>& leading) const {
    const std::size_t n = leading.size();
    values = bounded(name, n + 2);
    const Tensor& f = *file_.find(name);
    if (!std::equal(leading.begin(), leading.end(), f.shape.begin()) || f.shape[n] < 2 || f.shape[n + 1] < 2)
      file_.fail(f, fmt::format("expected a shape of {} x 2 or more x 2 or more, found {}", to_text(leading),
                                to_text(f.shape)));
    return {f.shape[n], f.shape[n + 1]};
  }
  /// A warp to nowhere has no inverse.
  void check_densities(const RglTables& t) const {
    const std::size_t slice = t.vndf_width * t.vndf_height;
    for (std::size_t s = 0; s * slice < t.vndf.size(); ++s) {
      const auto begin = t.vndf.begin() + std::ptrdiff_t(s * slice), end = begin + std::ptrdiff_t(slice);
      if (*std::min_element(begin, end) < 0) file_.fail(*file_.find("vndf"), "holds a negative number");
      if (*std::max_element(begin, end) <= 0)
        file_.fail(*file_.find("vndf"), fmt::format("slice {} is 0 everywhere", s));
    }
  }

  TensorFile file_;
};

} // namespace

RglBsdf parse_rgl(std::span<const std::uint8_t> bytes, std::string_view name) {
  return RglBsdf(RglReader(bytes, name).read());
}

std::vector<std::uint8_t> encode_rgl(const RglTables& t) {
  const std::vector<float> wavelengths(t.wavelengths_nm.begin(), t.wavelengths_nm.end());
  const std::vector<std::uint8_t> jacobian{std::uint8_t(t.jacobian)};
  const std::uint64_t phis = t.phi_i.size(), thetas = t.theta_i.size();
  std::vector<Tensor> fields{tensor("description", t.description),
                             tensor("phi_i", {phis}, t.phi_i),
                             tensor("theta_i", {thetas}, t.theta_i),
                             tensor("ndf", {t.ndf.height, t.ndf.width}, t.ndf.values),
                             tensor("sigma", {t.sigma.height, t.sigma.width}, t.sigma.values),
                             tensor("vndf", {phis, thetas, t.vndf_height, t.vndf_width}, t.vndf),
                             tensor("luminance", {phis, thetas, t.height, t.width}, t.luminance),
                             tensor("jacobian", {1}, std::span<const std::uint8_t>(jacobian)),
                             tensor(wavelengths.empty() ? "rgb" : "spectra",
                                    {phis, thetas, t.channel_count(), t.height, t.width}, t.spectra)};
  if (!wavelengths.empty()) fields.push_back(tensor("wavelengths", {wavelengths.size()}, wavelengths));
  return encode_tensor_file(fields);
}

} // namespace nacre
