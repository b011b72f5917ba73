// Requests for curves and lobes.
#include "report/curves.h"
#include "explorer/desk.h"

namespace nacre {

Answer answer_curves(const Arguments& request, const Desk& desk) {
  std::vector<std::shared_ptr<const MaterialSpec>> kept;
  std::vector<const MaterialSpec*> materials;
  for (const auto& entry : request.list("materials", 64)) {
    kept.push_back(desk.materials.resolve(entry, desk.folder));
    materials.push_back(kept.back().get());
  }
  const CurveKind kind = parse_curve_kind(request.text("kind"));
  CurveGeometry g;
  g.theta_i = request.angle("theta_i", g.theta_i, 0, 90);
  g.phi_i = request.angle("phi_i", g.phi_i);
  g.phi_o = request.angle("phi_o", g.phi_o);
  g.theta_d = request.angle("theta_d", g.theta_d, 0, 90);
  const Curves curves = make_curves(materials, kind, g, request.whole("points", 256, 2, 8192));

  Answer answer;
  const std::size_t n = curves.x.size();
  answer.add("x", {n}, std::vector<float>(curves.x.begin(), curves.x.end()));
  std::vector<float> y;
  y.reserve(materials.size() * n * 3);
  for (const auto& curve : curves.y)
    for (const auto& f : curve)
      for (const double v : f)
        y.push_back(float(v));
  answer.add("y", {materials.size(), n, 3}, std::move(y));
  answer.add("cosine", {n}, std::vector<float>(curves.cosine.begin(), curves.cosine.end()));
  return answer;
}

Answer answer_lobe3d(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  const double theta_i = request.angle("theta_i", 45, 0, 90), phi_i = request.angle("phi_i", 0);
  const int n_theta = request.whole("n_theta", 91, 2, 1024), n_phi = request.whole("n_phi", 181, 2, 2048);
  const double reach = transmits(*material) ? 180 : 90;
  const Vec3d wi = spherical_direction(std::min(theta_i, 90 - 1e-4) * pi / 180, phi_i * pi / 180);
  Directions pairs;
  for (int i = 0; i < n_theta; ++i) {
    // Nothing is defined in the surface itself.
    double theta = reach * i / (n_theta - 1);
    if (theta == 90) theta -= 1e-4;
    for (int k = 0; k < n_phi; ++k)
      pairs.add(spherical_direction(theta * pi / 180, 2 * pi * k / (n_phi - 1)), wi);
  }
  std::vector<float> f;
  f.reserve(pairs.size() * 3);
  for (const auto& rgb : evaluate_with_holes(*material, pairs))
    f.insert(f.end(), {float(rgb[0]), float(rgb[1]), float(rgb[2])});
  Answer answer;
  answer.header["theta_max"] = reach;
  answer.add("f", {std::size_t(n_theta), std::size_t(n_phi), 3}, std::move(f));
  return answer;
}

} // namespace nacre
