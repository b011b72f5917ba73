#pragma once
// The parameters of one plugin: read by name and kind, and counted, so that what nobody asked for is an
// error.

#include "core/vec.h"
#include "scene/mitsuba/document.h"
#include "scene/transform.h"

#include <initializer_list>
#include <optional>
#include <set>

namespace nacre::mitsuba {

/// Numbers in an attribute, separated by blanks or commas. @throws Error at the attribute
std::vector<double> read_numbers(const Node& node, const Attribute& attribute);
/// The one number in an attribute.
double read_number(const Node& node, const Attribute& attribute);
/// The child elements of a <transform>, the first applied first.
Transform read_transform(const Node& node);

class Parameters {
public:
  /// @throws Error if two parameters have one name, or a child is no parameter
  Parameters(const Node& node, const Document& document);

  const Node& node() const { return node_; }
  const std::string& type() const { return type_; }

  bool has(std::string_view name);
  double number(std::string_view name, double initial);
  int integer(std::string_view name, int initial);
  bool boolean(std::string_view name, bool initial);
  std::string text(std::string_view name, std::string_view initial);
  /// One of `choices`. @throws Error that suggests the nearest
  std::string choice(std::string_view name, std::string_view initial,
                     std::initializer_list<std::string> choices);
  /// Name of a file, found. @throws Error if the parameter is missing
  std::string file(std::string_view name = "filename");
  /// The path of a file that the value of `name` speaks of, looked up as `file` does.
  std::string file_named_in(std::string_view name, const std::string& file);
  std::optional<Vec3d> vector(std::string_view name);
  Transform transform(std::string_view name = "to_world");
  /// A parameter of any kind (a reference is followed), or null.
  const Node* find(std::string_view name);
  /// Where the parameter itself stands; it must exist.
  const Node& at(std::string_view name) const;

  /// Nested objects of that tag, written in place or referred to, that are not asked for by name.
  std::vector<const Node*> objects(std::string_view tag);
  /// Parameters that only steer noise, speed, or the file format.
  void ignore(std::initializer_list<std::string_view> names);
  /// @throws Error for a parameter that nobody asked for, with the nearest of those that were
  void finish() const;

private:
  struct Entry {
    const Node* written;  ///< the element itself
    const Node* resolved; ///< what it refers to
    bool used = false;
  };
  Entry* entry(std::string_view name);
  const Node* typed(std::string_view name, std::initializer_list<std::string_view> tags);

  const Node& node_;
  const Document& document_;
  std::string type_;
  std::vector<Entry> entries_;
  std::set<std::string> asked_;
};

} // namespace nacre::mitsuba
