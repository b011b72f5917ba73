#include "bsdf/user_model.h"

#include "bsdf/shader/compile_glsl.h"
#include "bsdf/shader/decode_spirv.h"
#include "bsdf/shader/machine.h"
#include "core/error.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <fmt/format.h>
#include <mutex>

namespace nacre {
namespace {

std::string glsl_type(BrdfFile::Parameter::Form form) {
  using Form = BrdfFile::Parameter::Form;
  return form == Form::number ? "float" : form == Form::truth ? "bool" : "vec3";
}

constexpr const char* wanted = "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)";

/// The uniforms that the user's text sees, and the directions.
std::string declarations(const BrdfFile& file) {
  std::string text;
  for (const auto& p : file.parameters)
    text += fmt::format("#line {}\nuniform {} {};\n", p.line, glsl_type(p.form), p.name);
  return text + "in vec3 nacre_wi;\nin vec3 nacre_wo;\nout vec3 nacre_f;\n";
}

constexpr const char* main_function =
    "void main() { nacre_f = BRDF(nacre_wi, nacre_wo, vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0)); }";

/// The machine of a program that this thread used lately, or a new one: what they keep is a program's
/// constants.
template <class R>
shader::Machine<R>& machine_of(std::uint64_t serial, const shader::Program& program,
                               const std::string& name) {
  struct Kept {
    std::uint64_t serial;
    std::unique_ptr<shader::Machine<R>> machine;
  };
  thread_local std::deque<Kept> kept;
  constexpr std::size_t most = 16;
  for (Kept& k : kept)
    if (k.serial == serial) return *k.machine;
  if (kept.size() == most) kept.pop_back();
  kept.push_front({serial, std::make_unique<shader::Machine<R>>(program, name)});
  return *kept.front().machine;
}

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

} // namespace

UserModel::UserModel(BrdfFile file) : file_(std::move(file)), serial_(next_serial()) {
  const shader::GlslText glsl(file_.shader, file_.name, file_.shader_line);
  // Where the text does not say: its first line.
  const auto line_of = [&](std::string_view word) { return std::max(glsl.line_of(word), file_.shader_line); };
  check_parameter_count();
  program_ = shader::decode_spirv(shader::compile_glsl(declarations(file_), glsl, main_function, wanted),
                                  file_.name, line_of);
  const auto check_given = [&](const shader::Program::Variable& v, bool is_given, const char* what) {
    if (!is_given)
      throw Error(fmt::format("{}:{}: '{}' is no {}", file_.name, line_of(v.name), v.name, what));
  };
  for (const auto& v : program_.uniforms)
    check_given(v,
                std::any_of(file_.parameters.begin(), file_.parameters.end(),
                            [&](const auto& p) { return p.name == v.name; }),
                "parameter of the file");
  for (const auto& v : program_.inputs)
    check_given(v, v.name == "nacre_wi" || v.name == "nacre_wo", "input here: the arguments of BRDF are");
  using Form = BrdfFile::Parameter::Form;
  info_.name = file_.name;
  info_.source = "user-written (.brdf)";
  info_.summary = "a GLSL function of the directions";
  info_.laws = {.reciprocal = false, .energy_gain = 1e30}; // claims nothing: the validator says what it keeps
  std::size_t place = 0;
  for (const auto& p : file_.parameters) {
    const bool color = p.form == Form::color;
    const bool varies = p.form != Form::truth && p.lo < p.hi;
    info_.parameters.push_back(
        {p.name, "1", "parameter of the file", p.lo, p.hi, p.initial[0], color, varies});
    initial_values_.push_back(p.initial);
    // What the shader does not use, the front end leaves out.
    for (const auto& u : program_.uniforms)
      if (u.name == p.name) uniforms_.push_back({u.kind, u.slots, place});
    place += color ? 3 : 1;
  }
  const auto slots_of = [](const std::vector<shader::Program::Variable>& list, std::string_view name) {
    for (const auto& v : list)
      if (v.name == name) return v.slots;
    return std::vector<std::int32_t>(); // the shader does not use it
  };
  wi_ = slots_of(program_.inputs, "nacre_wi");
  wo_ = slots_of(program_.inputs, "nacre_wo");
  f_ = slots_of(program_.outputs, "nacre_f");
  if (f_.size() != 3) throw Error(file_.name + ": the shader gives no value");
}

void UserModel::check_parameter_count() const {
  std::size_t numbers = 0;
  int line = 0; // of the first that has no room
  for (const auto& p : file_.parameters) {
    numbers += p.form == BrdfFile::Parameter::Form::color ? 3 : 1;
    if (numbers > std::size_t(max_parameter_numbers<3>) && line == 0) line = p.line;
  }
  if (line > 0)
    throw Error(fmt::format("{}:{}: {} numbers of parameters, more than the {} that a material holds",
                            file_.name, line, numbers, max_parameter_numbers<3>));
}

std::shared_ptr<const UserModel> UserModel::parse(std::string_view text, std::string_view name) {
  return std::shared_ptr<const UserModel>(new UserModel(parse_brdf_file(text, name)));
}

template <class R>
Spectrum<R, 3> UserModel::eval(std::span<const R> values, const Vec3<R>& wo, const Vec3<R>& wi) const {
  auto& machine = machine_of<R>(serial_, program_, file_.name);
  for (const Uniform& u : uniforms_)
    for (std::size_t k = 0; k < u.slots.size(); ++k) {
      if (u.kind == shader::Kind::number)
        machine.set(u.slots[k], values[u.value + k]);
      else
        machine.set_truth(u.slots[k], any(value(values[u.value]) > value_t<R>(0.5f)));
    }
  const auto give = [&](const std::vector<std::int32_t>& slots, const Vec3<R>& w) {
    if (slots.size() == 3) machine.set(slots[0], w.x), machine.set(slots[1], w.y), machine.set(slots[2], w.z);
  };
  give(wi_, wi);
  give(wo_, wo);
  machine.run();
  const auto above = same_upper_side(wo, wi);
  Spectrum<R, 3> f;
  for (int c = 0; c < 3; ++c)
    f[c] = select(above, *machine.number(f_[std::size_t(c)]), R(0));
  return f;
}

std::size_t UserModel::operations(std::span<const double> values) const {
  std::size_t most = 0;
  for (int n = 0; n < 24; ++n) {
    const double theta = 0.06 * n;
    eval<double>(values, spherical_direction(theta, 2.4 * n), spherical_direction(1.4 - theta, 5.1 * n));
    most = std::max(most, machine_of<double>(serial_, program_, file_.name).executed());
  }
  return most;
}

#define NACRE_USER_MODEL(R)                                                                                  \
  template Spectrum<R, 3> UserModel::eval(std::span<const R>, const Vec3<R>&, const Vec3<R>&) const;
NACRE_USER_MODEL(float)
NACRE_USER_MODEL(double)
NACRE_USER_MODEL(Pack)
using DualPack = Dual<Pack, 4>;
using DualDouble = Dual<double, 4>;
NACRE_USER_MODEL(DualPack)
NACRE_USER_MODEL(DualDouble)

} // namespace nacre
