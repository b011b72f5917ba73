#pragma once
// What the readers of a scene's parts share: the scene they fill, the document they read, and what they have
// read already.

#include "scene/mitsuba/parameters.h"
#include "scene/scene.h"

#include <map>
#include <memory>

namespace nacre::mitsuba {

/// What a colour is for: it decides how numbers and RGB become spectra.
enum class SpectrumUse {
  reflectance, ///< RGB in [0, 1]
  unbounded,   ///< RGB of any size: indices of refraction
  emission     ///< RGB and plain numbers are multiples of D65 of luminance 1
};

class Context {
public:
  Context(const Document& read, Scene& filled, bool strict)
      : document(read), scene(filled), strict_(strict) {}

  const Document& document;
  Scene& scene;

  /// Adds a warning to the scene. @throws Error instead if the reader is strict
  void warn(const Node& node, const std::string& message);
  /// @throws Error for a plugin that is not among `known`
  [[noreturn]] static void unknown_plugin(const Node& node, const std::vector<std::string>& known);

  // spectra.cpp
  SpectrumSource spectrum(const Node& node, SpectrumUse use);
  /// The spectrum of that parameter. Textures are an Error.
  SpectrumSource spectrum(Parameters& parameters, std::string_view name, SpectrumUse use, float initial);
  /// A parameter that may vary over the surface, of a color or of one number.
  std::optional<ParameterSource> color(Parameters& parameters, std::string_view name, SpectrumUse use);
  std::optional<ParameterSource> number(Parameters& parameters, std::string_view name);

  // textures.cpp
  std::shared_ptr<const Texture> texture(const Node& node, TextureUse use);
  /// Reads a texture that nothing has used, for the errors in it.
  void check_texture(const Node& node);

  // bsdfs.cpp
  /// Index of the material in the scene.
  int material(const Node& node);
  /// The material of shapes without one.
  int default_material();

  // shapes.cpp
  void shape(const Node& node);
  /// Index of the shapegroup in the scene.
  int group(const Node& node);

  // emitters.cpp
  void emitter(const Node& node);
  /// Radiance of an area emitter.
  ParameterSource area_emission(const Node& node);

  // camera.cpp
  /// Field of view of a perspective, from fov and fov_axis or focal_length.
  static void field_of_view(Parameters& parameters, Camera& camera);
  void sensor(const Node& node);
  void integrator(const Node& node);

  /// Emitters of type area that stand by themselves are there to be referred to.
  std::map<const Node*, bool> area_emitter_is_used;

private:
  Material build_material(const Node& node);
  std::optional<Shape> simple_shape(Parameters& parameters);
  void finish_shape(Parameters& parameters, Shape& shape, bool may_emit);
  void instance(Parameters& parameters);

  bool strict_;
  int default_material_ = -1;
  std::vector<const Node*>
      open_; ///< the objects being read, outermost first: they must not refer to themselves
  std::map<const Node*, int> materials_, groups_;
  std::map<std::pair<const Node*, TextureUse>, std::shared_ptr<const Texture>> textures_;
  friend class Opened;
};

/// Marks an object as being read, for as long as this lives. @throws Error if it is already
class Opened {
public:
  Opened(Context& context, const Node& node);
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  ~Opened();

private:
  Context& context_;
};

/// Calls f, and gives an Error without a place the place of `node`.
template <class F>
auto located(const Node& node, F&& f) {
  try {
    return f();
  } catch (const std::exception& e) {
    const std::string_view what = e.what();
    if (what.starts_with(*node.file + ":")) throw;
    node.fail(what);
  }
}

} // namespace nacre::mitsuba
