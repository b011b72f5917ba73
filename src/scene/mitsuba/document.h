#pragma once
// A Mitsuba scene file as a tree of elements: includes spliced in, $parameters replaced, names of the 0.x
// dialect brought to those of versions 2 and 3, and every element and attribute with its place in its file.

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace nacre::mitsuba {

struct Attribute {
  std::string name, value;
  int line = 0, column = 0; ///< of its name
};

struct Node {
  std::string tag;
  std::vector<Attribute> attributes;
  std::vector<Node> children;
  std::shared_ptr<const std::string> file;
  int line = 0, column = 0; ///< of its name
  bool is_old = false;      ///< written for Mitsuba 0.x

  const Attribute* find(std::string_view name) const;
  /// The value of that attribute, or empty.
  std::string_view get(std::string_view name) const;
  /// @throws Error if the element lacks it
  const Attribute& require(std::string_view name) const;
  [[noreturn]] void fail(std::string_view message) const;
  [[noreturn]] void fail_at(const Attribute& attribute, std::string_view message) const;
  std::string location() const; ///< "FILE:LINE:COLUMN"
};

/// True for the tags of plugins: bsdf, shape, emitter, ...
bool is_object_tag(std::string_view tag);

struct Document {
  Node scene;                       ///< the element `scene`; its children never are include, default or path
  std::vector<std::string> folders; ///< where files are looked up besides the folder of the naming file
  std::map<std::string, const Node*> ids; ///< elements with an id, and their aliases; point into `scene`

  Document() = default;
  Document(Document&&) = default;
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// The element a `ref` names. @throws Error that suggests the nearest id
  const Node& target(const Node& ref) const;
  /// The file of that name, looked up beside the file of `node` and in `folders`.
  /// @throws Error at `node` that says where it was looked for
  std::string find_file(const Node& node, const std::string& name) const;
};

/// @param text         the file's contents
/// @param definitions  parameters set from outside; they win over `default` elements
/// @throws Error with file, line and column; also if a definition is never used
Document read_document(const std::string& text, const std::string& file,
                       const std::vector<std::string>& folders,
                       const std::map<std::string, std::string>& definitions);

} // namespace nacre::mitsuba
