#include "cli/model_reference.h"

#include "measured/material_spec.h"

#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr std::string_view preface = R"(# Models

<!-- Written by `nacre materials --markdown`; `./nacre figures` writes it anew. -->

The reference of all models, generated from what each declares about itself.
[adding-a-model.md](adding-a-model.md) says how to add one.

On the command line a material is `NAME:PARAM=VALUE,...`, with a colour as `R/G/B`; `+` adds lobes, and `WEIGHT*`
before a name weighs one: `ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2+0.5*lambert:reflectance=0.1`. In a scene file it is
`<bsdf type="NAME">` with these parameters, or `<bsdf type="nacre">` with that text as the string `material`.

- *Colour*: a value per channel or wavelength; in a scene any parameter may be a texture.
- *Domain*: what is accepted, and the bounds of a fit. *Fitted*: whether `nacre fit` varies it.
- *Claims*: what the tests hold the model to; [validate.md](validate.md) says how.
- The pictures show the materials of [scenes/materials.txt](scenes/materials.txt). The curves are luminance in the
  plane of incidence for light from 0, 30 and 60 degrees. What a smooth model reflects into one direction is no value
  in 1/sr and has no curve.

| model | what it describes |
|---|---|
)";

std::string laws(const Laws& laws) {
  std::string text = laws.transmits    ? "reflects and transmits; reciprocal with the eta² of transmission"
                     : laws.reciprocal ? "reflects; reciprocal"
                                       : "reflects; **not reciprocal**";
  text += laws.energy_gain > 0 ? fmt::format("; **gains** up to {:.2g} % of energy", 100 * laws.energy_gain)
                               : "; never gains energy";
  return text;
}

/// False for a model that is delta directions and nothing else: its curve would be empty.
bool has_values(const std::string& name) {
  const double s = std::sqrt(0.5);
  return max_component(make_bsdf<double>(parse_material(name)).eval({s, 0, s}, {-s, 0, s})) > 0;
}

std::string section(const ModelInfo& model) {
  const auto picture = [&](std::string_view extension) {
    return fmt::format(R"(<img src="pictures/models/{0}.{1}" height="165" alt="{0}">)", model.name,
                       extension);
  };
  std::string summary = model.summary;
  summary[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(summary[0])));
  std::string text = fmt::format("\n## `{}`\n\n{}", model.name, picture("jpg"));
  if (has_values(model.name)) text += " " + picture("svg");
  text += fmt::format("\n\n{}. Source: {}. Claims: {}.\n\n", summary, model.source, laws(model.laws));
  text +=
      "| parameter | kind | unit | domain | default | fitted | meaning |\n|---|---|---|---|---|---|---|\n";
  for (const ParameterInfo& p : model.parameters)
    text += fmt::format("| `{}` | {} | {} | {:g} to {:g} | {:g} | {} | {} |\n", p.name,
                        p.per_channel ? "colour" : "number", p.unit, p.lo, p.hi, p.initial,
                        p.fitted ? "yes" : "no", p.meaning);
  return text;
}

} // namespace

std::string model_reference(const std::vector<ModelInfo>& models) {
  std::string text(preface);
  for (const ModelInfo& model : models)
    text += fmt::format("| [`{0}`](#{0}) | {1} |\n", model.name, model.summary);
  for (const ModelInfo& model : models)
    text += section(model);
  return text;
}

} // namespace nacre
