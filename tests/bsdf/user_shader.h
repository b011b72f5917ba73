#pragma once
// Small .brdf files for tests, with lines that are known.

#include "bsdf/user_model.h"
#include "core/error.h"

#include <memory>
#include <string>

namespace nacre::user_shader {

constexpr const char* signature = "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)";

/// A file whose shader begins in line 9: a float `a` in [0, 2] at 0.5, a bool `on`, a colour `tone`.
inline std::string file(const std::string& shader) {
  return "analytic\n# three parameters\n::begin parameters\nfloat a 0 2 0.5\nbool on 0\n"
         "color tone 0.2 0.4 0.6\n::end parameters\n::begin shader\n" +
         shader + "\n::end shader\n";
}
/// The same with a body alone; it stands in line 10.
inline std::string body(const std::string& statements) {
  return file(std::string(signature) + " {\n" + statements + "\n}");
}

/// The parameter vector of the file's own values.
template <class R>
std::vector<R> initial(const UserModel& model) {
  std::vector<R> values;
  const auto& declared = model.info().parameters;
  for (std::size_t i = 0; i < declared.size(); ++i)
    for (std::size_t c = 0; c < (declared[i].per_channel ? 3 : 1); ++c)
      values.push_back(R(constant<R>(model.initial_values()[i][c])));
  return values;
}

/// f of the file's own values.
inline std::array<double, 3> value(const std::string& text, const Vec3d& wo, const Vec3d& wi) {
  const auto model = UserModel::parse(text, "t.brdf");
  return model->eval<double>(initial<double>(*model), wo, wi).c;
}

/// What is said of a file that cannot be read or run.
inline std::string message(const std::string& text) {
  try {
    value(text, spherical_direction(0.4, 0.3), spherical_direction(0.7, 2.0));
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

/// A model with facets, a tint that mixes channels, and a switch.
inline const std::string& cloth() {
  static const std::string text = R"(analytic
::begin parameters
color base 0.6 0.3 0.1
float gloss 0.05 1 0.3
float level 0 2 0.5
float tint 0 1 0.5
bool sharp 0
::end parameters
::begin shader
const float PI = 3.14159265358979;
float facets(float c, float alpha)
{
  float t = 1.0 + (alpha * alpha - 1.0) * c * c;
  return alpha * alpha / (PI * t * t);
}
vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)
{
  vec3 H = normalize(L + V);
  float brightness = dot(base, vec3(0.3, 0.6, 0.1));
  vec3 hue = brightness > 0.0 ? base / brightness : vec3(1);
  float D = facets(dot(N, H), sharp ? gloss * gloss : gloss);
  return base / PI + level * D * mix(vec3(1), hue, tint);
}
::end shader
)";
  return text;
}

} // namespace nacre::user_shader
