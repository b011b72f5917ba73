#include "cli/model_reference.h"

#include <fmt/format.h>

namespace nacre {
namespace {

std::string laws(const Laws& laws) {
  std::string text = laws.transmits    ? "reflects and transmits; reciprocal with the eta² of transmission"
                     : laws.reciprocal ? "reflects; reciprocal"
                                       : "reflects; **not reciprocal**";
  text += laws.energy_gain > 0 ? fmt::format("; **gains** up to {:.2g} % of energy", 100 * laws.energy_gain)
                               : "; never gains energy";
  return text;
}

std::string row(const ParameterInfo& p) {
  return fmt::format("| `{}` | {} | {} | {:g} to {:g} | {:g} | {} | {} |\n", p.name,
                     p.per_channel ? "colour" : "number", p.unit, p.lo, p.hi, p.initial,
                     p.fitted ? "yes" : "no", p.meaning);
}

std::string section(const ModelInfo& model) {
  std::string text =
      fmt::format("\n## `{0}`\n\n"
                  "<img src=\"pictures/models/{0}.png\" height=\"165\" alt=\"{0}, rendered\"> "
                  "<img src=\"pictures/models/{0}.svg\" height=\"165\" alt=\"{0}, its lobes\">\n\n"
                  "{1}. Source: {2}. Claims: {3}.\n\n",
                  model.name, model.summary, model.source, laws(model.laws));
  text +=
      "| parameter | kind | unit | domain | default | fitted | meaning |\n|---|---|---|---|---|---|---|\n";
  for (const ParameterInfo& p : model.parameters)
    text += row(p);
  return text;
}

} // namespace

std::string model_reference(const std::vector<ModelInfo>& models) {
  std::string text =
      "# Models\n\n"
      "<!-- Written by `nacre materials --markdown`; `./nacre figures` writes it anew. -->\n\n"
      "The reference of all models, generated from what each declares about itself. "
      "[adding-a-model.md](adding-a-model.md) says how to add one.\n\n"
      "On the command line a material is `NAME:PARAM=VALUE,...`, with a colour as `R/G/B`, and "
      "`+` adds lobes: `ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2+lambert:reflectance=0.1`. In a scene "
      "file it is `<bsdf type=\"NAME\">` with these parameters.\n\n"
      "*Colour*: a value per channel or wavelength; textures too, in scenes. *Domain*: what is "
      "accepted, and the bounds of a fit. *Fitted*: whether `nacre fit` varies it. *Claims*: what "
      "the tests hold the model to; [validate.md](validate.md) says how. The pictures show a "
      "material with the parameters of `docs/scenes/materials.txt`; the curves are its values in "
      "the plane of incidence, in 1/sr, for light from 0, 30 and 60 degrees. What a smooth model reflects "
      "into its one mirror direction is no value in 1/sr, and is not in the curves.\n\n";
  text += "| model | what it describes |\n|---|---|\n";
  for (const ModelInfo& model : models)
    text += fmt::format("| [`{0}`](#{0}) | {1} |\n", model.name, model.summary);
  for (const ModelInfo& model : models)
    text += section(model);
  return text;
}

} // namespace nacre
