#pragma once
// A material as a person writes it: "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2+lambert:reflectance=0.1", the same
// with models of the user's own ("shaders/cloth.brdf:gloss=0.3+lambert"), a measured file, or a JSON file
// that a fit wrote.

#include "measured/bsdf.h"

#include <array>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// One lobe: a model of the list or of a .brdf file with its values in linear RGB, or a measured table.
struct LobeSpec {
  int model = -1; ///< index into model_infos(); -1: not of the list
  std::vector<std::array<double, 3>>
      values; ///< one a declared parameter; a scalar parameter has it three times
  double weight = 1;
  std::shared_ptr<const MeasuredBsdf> measured; ///< a table, or `user` at `values`; null for a listed model
  std::shared_ptr<const UserModel> user = nullptr; ///< of a .brdf file; null for all else

  bool is_table() const { return measured && !user; }
};

struct MaterialSpec {
  std::string name; ///< what to call it in a report: the text or the file it came from
  std::vector<LobeSpec> lobes;
  std::string argument = {}; ///< the text that parse_material was given, for commands; may be empty
};

/// The path of a file that a material names. @throws Error if there is none, or it may not be read
using FileFinder = std::function<std::string(const std::string& name)>;

/// @param text  [WEIGHT*]NAME[:PARAM=VALUE,...][+NAME...] with NAME a model of the list or a path that ends
/// in .brdf, VALUE a number or R/G/B; alpha for alpha_x and alpha_y, metal=NAME for eta and k, glass=NAME for
/// eta (spectra/named_ior.h). Or a path to a measurement (measured/formats.h) or a .json. A path with a '+'
/// in it stands alone
/// @param find  of every file named; none: as it is written
/// @throws Error naming the unknown model, file or parameter and the nearest valid one, or the value outside
/// its domain
MaterialSpec parse_material(const std::string& text, const FileFinder& find = {});
/// A .brdf file is looked for beside `file`, then as it is written.
MaterialSpec material_from_json(const nlohmann::json& json, const std::string& file,
                                const FileFinder& find = {});
/// Models by name, .brdf files by path. @throws Error for a measured table
nlohmann::json to_json(const MaterialSpec& material);
/// The text form of a material of models, listed or of files; values with as many digits as they need.
std::string to_text(const MaterialSpec& material);
/// A lobe of this model with every parameter at its default.
LobeSpec default_lobe(int model);
/// A lobe of a .brdf file. @throws Error for a value outside its domain
LobeSpec user_lobe(std::shared_ptr<const UserModel> model, std::vector<std::array<double, 3>> values,
                   double weight = 1);
/// What the lobe's model declares. The lobe is no table.
const ModelInfo& model_info(const LobeSpec& lobe);

/// The parameter vector of three channels, as model_functions take it. The lobe is no table.
std::vector<double> parameter_vector(const LobeSpec& lobe);

/// The material as a value to evaluate, in linear RGB.
template <class R>
Bsdf<R, 3> make_bsdf(const MaterialSpec& material) {
  Bsdf<R, 3> bsdf;
  for (const LobeSpec& lobe : material.lobes) {
    if (lobe.measured) {
      bsdf.add(BsdfLobe<R, 3>(MeasuredLobe<R, 3>(lobe.measured.get())), float(lobe.weight));
      continue;
    }
    std::vector<R> values;
    for (const double x : parameter_vector(lobe))
      values.push_back(constant<R>(x));
    BsdfLobe<R, 3> model(lobe.model, values);
    model.prepare();
    bsdf.add(model, float(lobe.weight));
  }
  return bsdf;
}

} // namespace nacre
