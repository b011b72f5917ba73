#include "scene/mitsuba/context.h"

#include "core/error.h"
#include "core/file.h"
#include "core/text_scanner.h"
#include "scene/mitsuba.h"

#include <algorithm>

namespace nacre {
namespace mitsuba {

void Context::warn(const Node& node, const std::string& message) {
  if (strict_) node.fail(message);
  scene.warnings.push_back(node.location() + ": " + message);
}

void Context::unknown_plugin(const Node& node, const std::vector<std::string>& known) {
  const Attribute& type = node.require("type");
  std::string list;
  for (const std::string& name : known)
    list += (list.empty() ? "" : ", ") + name;
  const std::string nearest = nearest_name(type.value, known);
  node.fail_at(type, node.tag + " " + in_quotes(type.value) + " is not supported" +
                         (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)") + "; known: " + list);
}

Opened::Opened(Context& context, const Node& node) : context_(context) {
  auto& open = context.open_;
  if (std::find(open.begin(), open.end(), &node) != open.end()) node.fail("this object refers to itself");
  constexpr std::size_t deepest = 64;
  if (open.size() >= deepest) node.fail("objects refer to each other more than 64 deep");
  open.push_back(&node);
}
Opened::~Opened() { context_.open_.pop_back(); }

namespace {

void read_top_level(Context& context) {
  const Document& document = context.document;
  const Node* sensor = nullptr;
  const Node* integrator = nullptr;
  for (const Node& node : document.scene.children) {
    // Objects at the top are read even if nothing refers to them: an error in them is an error of the scene.
    if (node.tag == "bsdf") {
      context.material(node);
    } else if (node.tag == "shape") {
      if (node.get("type") == "shapegroup")
        context.group(node);
      else
        context.shape(node);
    } else if (node.tag == "emitter") {
      context.emitter(node);
    } else if (node.tag == "sensor") {
      if (sensor != nullptr)
        context.warn(node,
                     "the scene has more than one sensor; the first, at " + sensor->location() + ", is used");
      else
        context.sensor(*(sensor = &node));
    } else if (node.tag == "integrator") {
      if (integrator != nullptr)
        node.fail("the scene has more than one integrator: see " + integrator->location());
      context.integrator(*(integrator = &node));
    } else if (node.tag == "medium" || node.tag == "volume" || node.tag == "phase") {
      node.fail("participating media are not supported");
    } else if (node.tag == "ref" ||
               (node.find("id") == nullptr && node.tag != "alias" && node.tag != "texture")) {
      node.fail("<" + node.tag + "> has no meaning directly in <scene>");
    }
  }
  for (const Node& node : document.scene.children)
    if (node.tag == "texture") context.check_texture(node); // now that its uses have decided how it is read
  for (const auto& [node, used] : context.area_emitter_is_used)
    if (!used) node->fail("an emitter of type area belongs into a shape, or is referred to by one");
  if (sensor == nullptr) context.warn(document.scene, "the scene has no sensor: a default camera is used");
}

} // namespace
} // namespace mitsuba

Scene parse_mitsuba_scene(const std::string& text, const std::string& name, const MitsubaOptions& options) {
  const auto document = mitsuba::read_document(text, name, options.folders, options.definitions);
  Scene scene;
  scene.file = name;
  mitsuba::Context context(document, scene, options.strict);
  mitsuba::read_top_level(context);
  return scene;
}

Scene read_mitsuba_scene(const std::string& path, const MitsubaOptions& options) {
  return parse_mitsuba_scene(read_text_file(path), path, options);
}

} // namespace nacre
