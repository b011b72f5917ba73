#pragma once
// A reflectance model that a user wrote as GLSL in a .brdf file, run by the core itself on any number type:
// it plots, validates, fits with exact derivatives and renders like a model of the list.

#include "bsdf/brdf_file.h"
#include "bsdf/model_functions.h"
#include "bsdf/model_info.h"
#include "bsdf/shader/program.h"

#include <memory>
#include <span>

namespace nacre {

class UserModel {
public:
  /// @throws Error with the line for what is not such a file, or does not compile, or is too large
  static std::shared_ptr<const UserModel> parse(std::string_view text, std::string_view name);

  const ModelInfo& info() const { return info_; }
  /// A bool of the file: 0 or 1.
  bool is_switch(std::size_t parameter) const {
    return file_.parameters[parameter].form == BrdfFile::Parameter::Form::truth;
  }
  /// Where the file's parameters begin, one a declared parameter; a scalar has its number three times.
  const std::vector<std::array<double, 3>>& initial_values() const { return initial_values_; }

  /// f in 1/sr, linear RGB, 0 where a direction lies below the surface. @param values  as
  /// ModelFunctions<R, 3> take them: three numbers for a colour, one for others
  /// @throws Error with the line for a loop without end or an index outside its array
  /// R = float, double, Pack, or dual numbers over double or packs.
  template <class R>
  Spectrum<R, 3> eval(std::span<const R> values, const Vec3<R>& wo, const Vec3<R>& wi) const;

  /// Operations that a value takes: the most at some pairs of directions. @throws Error as eval
  std::size_t operations(std::span<const double> values) const;

private:
  explicit UserModel(BrdfFile file);
  void check_parameter_count() const;

  BrdfFile file_;
  ModelInfo info_;
  std::vector<std::array<double, 3>> initial_values_;
  shader::Program program_;
  std::vector<std::int32_t> wi_, wo_, f_; ///< slots of the inputs and the output
  struct Uniform {
    shader::Kind kind;
    std::vector<std::int32_t> slots;
    std::size_t value; ///< place in the parameter vector
  };
  std::vector<Uniform> uniforms_;
  std::uint64_t serial_; ///< tells models apart for the machines that threads keep
};

} // namespace nacre
