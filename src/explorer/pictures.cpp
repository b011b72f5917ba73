// Requests for pictures that need no renderer.
#include "explorer/desk.h"
#include "report/material_images.h"

namespace nacre {
namespace {

constexpr int largest = 4096;

Answer image_answer(const Image& image) {
  Answer answer;
  answer.add_image("image", image);
  return answer;
}

} // namespace

Answer answer_sphere(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  SphereLight light;
  light.theta_deg = request.angle("theta_i", light.theta_deg);
  light.phi_deg = request.angle("phi_i", light.phi_deg);
  light.cosine = request.truth("cosine", true);
  light.double_theta = request.truth("double_theta", false);
  light.holes = true;
  return image_answer(lit_sphere(*material, request.whole("size", 256, 1, largest), light));
}

Answer answer_slice(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  SliceAxes axes;
  axes.phi_d_deg = request.angle("phi_d", axes.phi_d_deg);
  axes.square_root = request.truth("sqrt_theta_h", true);
  axes.double_theta = request.truth("double_theta", false);
  axes.holes = true;
  return image_answer(image_slice(*material, request.whole("size", 256, 1, largest), axes));
}

Answer answer_furnace(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  const int size = request.whole("size", 128, 8, 1024);
  if (!request.has("parameter") || request.text("parameter").empty())
    return image_answer(furnace_sphere(*material, size));
  const std::string parameter = request.text("parameter");
  const auto domain = parameter_domain(*material, parameter);
  const double lo = std::max(domain[0], -1e3), hi = std::min(domain[1], lo + 1);
  constexpr int spheres = 6;
  std::vector<double> values;
  for (int i = 0; i < spheres; ++i)
    values.push_back(lo + (hi - lo) * i / (spheres - 1));
  Answer answer = image_answer(white_furnace(*material, parameter, values, size));
  answer.header["parameter"] = parameter;
  answer.header["values"] = values;
  return answer;
}

} // namespace nacre
