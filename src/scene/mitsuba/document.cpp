#include "scene/mitsuba/document.h"

#include "core/error.h"
#include "core/file.h"
#include "core/text_scanner.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <functional>
#include <pugixml.hpp>
#include <set>
#include <sstream>

namespace nacre::mitsuba {
namespace {

namespace fs = std::filesystem;

constexpr int deepest_nesting = 64;
constexpr int deepest_include = 16;
constexpr int most_includes = 1000;

using Names = std::vector<std::string>;

/// The attributes an element may have.
const std::map<std::string, Names, std::less<>>& attributes_of_tags() {
  static const std::map<std::string, Names, std::less<>> table = [] {
    std::map<std::string, Names, std::less<>> t;
    for (const char* tag : {"integrator", "sensor", "sampler", "film", "rfilter", "emitter", "shape", "bsdf",
                            "texture", "medium", "phase", "volume"})
      t[tag] = {"type", "id", "name", "version"};
    t["scene"] = {"version", "type", "id"};
    for (const char* tag : {"float", "integer", "boolean", "string", "rgb", "srgb", "color"})
      t[tag] = {"name", "value", "id"};
    t["spectrum"] = {"name", "value", "filename", "type", "id"};
    t["blackbody"] = {"name", "temperature", "scale"};
    for (const char* tag : {"point", "vector"})
      t[tag] = {"name", "x", "y", "z", "value"};
    t["transform"] = {"name", "id"};
    t["translate"] = t["scale"] = {"x", "y", "z", "value"};
    t["rotate"] = {"x", "y", "z", "value", "angle"};
    t["lookat"] = {"origin", "target", "up"};
    t["matrix"] = {"value"};
    t["ref"] = {"name", "id"};
    t["alias"] = {"id", "as"};
    t["include"] = {"filename"};
    t["default"] = {"name", "value"};
    t["path"] = {"value"};
    return t;
  }();
  return table;
}

/// "intIOR" -> "int_ior", "toWorld" -> "to_world": what Mitsuba 2 does to the names of older scenes.
std::string snake_case(std::string_view camel) {
  std::string snake;
  for (std::size_t i = 0; i < camel.size(); ++i) {
    const auto c = static_cast<unsigned char>(camel[i]);
    if (i > 0 && std::isupper(c) && std::islower(static_cast<unsigned char>(camel[i - 1]))) snake += '_';
    snake += static_cast<char>(std::tolower(c));
  }
  return snake;
}

bool is_name_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

/// Turns offsets into lines and columns.
class Lines {
public:
  explicit Lines(std::string_view text) : text_(text) {
    for (std::size_t i = 0; i < text.size(); ++i)
      if (text[i] == '\n') starts_.push_back(i + 1);
  }
  std::pair<int, int> at(std::ptrdiff_t offset) const {
    const auto o = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(offset, 0, std::ssize(text_)));
    const auto after = std::upper_bound(starts_.begin(), starts_.end(), o);
    return {static_cast<int>(after - starts_.begin()), static_cast<int>(o - *(after - 1)) + 1};
  }
  /// Offset of the n-th attribute's name of the element whose name begins at `element`.
  std::vector<std::ptrdiff_t> attribute_offsets(std::ptrdiff_t element) const {
    std::vector<std::ptrdiff_t> offsets;
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    std::size_t i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(element, 0));
    while (i < text_.size() && !blank(text_[i]) && text_[i] != '>' && text_[i] != '/')
      ++i;
    while (i < text_.size()) {
      while (i < text_.size() && blank(text_[i]))
        ++i;
      if (i >= text_.size() || text_[i] == '>' || text_[i] == '/') break;
      offsets.push_back(static_cast<std::ptrdiff_t>(i));
      const std::size_t open = text_.find_first_of("\"'", i);
      if (open == std::string_view::npos) break;
      const std::size_t close = text_.find(text_[open], open + 1);
      if (close == std::string_view::npos) break;
      i = close + 1;
    }
    return offsets;
  }

private:
  std::string_view text_;
  std::vector<std::size_t> starts_{0};
};

/// Reads one file after another into one tree.
class Builder {
public:
  Builder(Document& document, const std::vector<std::string>& folders,
          const std::map<std::string, std::string>& definitions)
      : document_(document), outer_folders_(folders), definitions_(definitions), values_(definitions) {}

  void read(const std::string& text, const std::string& file);
  void finish();

private:
  struct File {
    std::shared_ptr<const std::string> name;
    const Lines& lines;
    bool is_old;
    std::string folder;
  };

  void splice(const std::string& text, const std::string& file, Node& scene);
  Node element(const pugi::xml_node& xml, const File& file);
  void children(const pugi::xml_node& xml, const File& file, Node& node, int depth);
  void check_attributes(const Node& node) const;
  void include(const Node& node, Node& scene);
  std::string substituted(const Node& node, const Attribute& attribute);

  Document& document_;
  const std::vector<std::string>& outer_folders_;
  const std::map<std::string, std::string>& definitions_;
  std::map<std::string, std::string> values_;
  std::set<std::string> used_;
  std::vector<std::string> open_files_; ///< the file being read and those that include it
  int includes_ = 0;
};

std::string Builder::substituted(const Node& node, const Attribute& attribute) {
  const std::string& text = attribute.value;
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] != '$') {
      result += text[i++];
      continue;
    }
    std::size_t end = i + 1;
    while (end < text.size() && is_name_character(text[end]))
      ++end;
    // "$name" may run into more letters: the longest defined name counts.
    std::size_t length = end - i - 1;
    while (length > 0 && values_.count(text.substr(i + 1, length)) == 0)
      --length;
    if (length == 0) {
      Names known;
      for (const auto& [name, value] : values_)
        known.push_back(name);
      node.fail_at(attribute, "the parameter " + in_quotes(text.substr(i, end - i)) + " has no value" +
                                  suggestion(text.substr(i + 1, end - i - 1), known));
    }
    const std::string name = text.substr(i + 1, length);
    used_.insert(name);
    result += values_.at(name);
    i += 1 + length;
  }
  return result;
}

void Builder::check_attributes(const Node& node) const {
  const auto& table = attributes_of_tags();
  const auto known = table.find(node.tag);
  if (known == table.end()) {
    Names tags;
    for (const auto& [tag, names] : table)
      tags.push_back(tag);
    node.fail("unknown element <" + node.tag + ">" + suggestion(node.tag, tags));
  }
  for (const Attribute& a : node.attributes)
    if (std::find(known->second.begin(), known->second.end(), a.name) == known->second.end())
      node.fail_at(a, "<" + node.tag + "> has no attribute " + in_quotes(a.name) +
                          suggestion(a.name, known->second));
}

Node Builder::element(const pugi::xml_node& xml, const File& file) {
  Node node;
  node.tag = xml.name();
  node.file = file.name;
  node.is_old = file.is_old;
  std::tie(node.line, node.column) = file.lines.at(xml.offset_debug());
  if (file.is_old && node.tag == "lookAt") node.tag = "lookat";
  const auto offsets = file.lines.attribute_offsets(xml.offset_debug());
  std::size_t i = 0;
  for (const auto& a : xml.attributes()) {
    Attribute attribute{a.name(), a.value(), node.line, node.column};
    if (i < offsets.size()) std::tie(attribute.line, attribute.column) = file.lines.at(offsets[i++]);
    if (node.find(attribute.name) != nullptr)
      node.fail_at(attribute, "the attribute " + in_quotes(attribute.name) + " is given twice");
    node.attributes.push_back(std::move(attribute));
  }
  check_attributes(node);
  for (Attribute& a : node.attributes) {
    a.value = substituted(node, a);
    if (file.is_old && a.name == "name" && node.tag != "default") a.value = snake_case(a.value);
  }
  return node;
}

void Builder::include(const Node& node, Node& scene) {
  const Attribute& filename = node.require("filename");
  const std::string path = document_.find_file(node, filename.value);
  std::error_code ignored;
  const fs::path canonical = fs::weakly_canonical(path, ignored);
  for (const std::string& open : open_files_)
    if (fs::weakly_canonical(open, ignored) == canonical)
      node.fail_at(filename, "the file includes itself: '" + path + "' is being read already");
  if (std::ssize(open_files_) >= deepest_include)
    node.fail_at(filename, "files include each other more than " + std::to_string(deepest_include) + " deep");
  if (++includes_ > most_includes)
    node.fail_at(filename, "more than " + std::to_string(most_includes) + " files are included");
  splice(read_text_file(path), path, scene);
}

void Builder::children(const pugi::xml_node& xml, const File& file, Node& node, int depth) {
  for (const auto& child : xml.children()) {
    if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
      const auto [line, column] = file.lines.at(child.offset_debug());
      throw Error::in_text(*file.name, line, column,
                           "expected an element, found text " + in_quotes(child.value()));
    }
    if (child.type() != pugi::node_element) continue;
    Node made = element(child, file);
    if (depth > deepest_nesting)
      made.fail("elements are nested more than " + std::to_string(deepest_nesting) + " deep");
    if (made.tag == "default") {
      values_.emplace(made.require("name").value, made.require("value").value);
    } else if (made.tag == "path" || made.tag == "include") {
      if (node.tag != "scene") made.fail("<" + made.tag + "> belongs directly into <scene>");
      if (made.tag == "include") {
        include(made, node);
        continue;
      }
      const Attribute& value = made.require("value");
      const fs::path folder = fs::path(file.folder) / value.value;
      std::error_code ignored;
      if (!fs::is_directory(folder, ignored))
        made.fail_at(value, "there is no folder '" + folder.string() + "'");
      document_.folders.push_back(folder.string());
    } else {
      children(child, file, made, depth + 1);
      node.children.push_back(std::move(made));
    }
  }
}

void Builder::splice(const std::string& text, const std::string& file, Node& scene) {
  const auto name = std::make_shared<const std::string>(file);
  const Lines lines(text);
  pugi::xml_document xml;
  const auto result = xml.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    const auto [line, column] = lines.at(result.offset);
    throw Error::in_text(file, line, column, std::string("not well-formed XML: ") + result.description());
  }
  const pugi::xml_node root = xml.document_element();
  if (std::string_view(root.name()) != "scene") {
    const auto [line, column] = lines.at(root.offset_debug());
    throw Error::in_text(file, line, column, "expected <scene>, found <" + std::string(root.name()) + ">");
  }
  open_files_.push_back(file);
  const std::string folder = fs::path(file).parent_path().string();
  File current{name, lines, false, folder.empty() ? "." : folder};
  Node made = element(root, current);
  double version = 3;
  if (const Attribute* v = made.find("version")) {
    double number = 0;
    if (!parse_number(v->value.substr(0, v->value.find('.')), number) || number < 0)
      made.fail_at(*v, "expected a version such as 3.0.0, found " + in_quotes(v->value));
    version = number;
    if (version > 3) made.fail_at(*v, "versions up to 3 are supported, found " + in_quotes(v->value));
  }
  current.is_old = version < 2;
  made.is_old = current.is_old;
  if (scene.tag.empty()) scene = made;
  children(root, current, scene, 1);
  open_files_.pop_back();
}

void Builder::read(const std::string& text, const std::string& file) {
  const std::string folder = fs::path(file).parent_path().string();
  document_.folders.push_back(folder.empty() ? "." : folder);
  document_.folders.insert(document_.folders.end(), outer_folders_.begin(), outer_folders_.end());
  splice(text, file, document_.scene);
  finish();
}

void Builder::finish() {
  for (const auto& [name, value] : definitions_) {
    if (used_.count(name) != 0) continue;
    Names known;
    for (const auto& [other, v] : values_)
      if (definitions_.count(other) == 0 || used_.count(other) != 0) known.push_back(other);
    throw Error::in_file(*document_.scene.file, "the scene has no parameter " + in_quotes(name) +
                                                    ", which -D sets" + suggestion(name, known));
  }
  const std::function<void(const Node&)> collect = [&](const Node& node) {
    const Attribute* id = node.find("id");
    if (id != nullptr && node.tag != "ref" && node.tag != "alias") {
      const auto [at, is_new] = document_.ids.emplace(id->value, &node);
      if (!is_new)
        node.fail_at(*id, "the id " + in_quotes(id->value) + " is taken: see " + at->second->location());
    }
    for (const Node& child : node.children)
      collect(child);
  };
  for (const Node& child : document_.scene.children)
    collect(child);
  for (const Node& node : document_.scene.children)
    if (node.tag == "alias") {
      const Attribute& as = node.require("as");
      if (!document_.ids.emplace(as.value, &document_.target(node)).second)
        node.fail_at(as, "the id " + in_quotes(as.value) + " is taken");
    }
}

} // namespace

const Attribute* Node::find(std::string_view name) const {
  for (const Attribute& a : attributes)
    if (a.name == name) return &a;
  return nullptr;
}
std::string_view Node::get(std::string_view name) const {
  const Attribute* a = find(name);
  return a == nullptr ? std::string_view() : std::string_view(a->value);
}
const Attribute& Node::require(std::string_view name) const {
  if (const Attribute* a = find(name)) return *a;
  fail("<" + tag + "> lacks the attribute '" + std::string(name) + "'");
}
void Node::fail(std::string_view message) const { throw Error::in_text(*file, line, column, message); }
void Node::fail_at(const Attribute& attribute, std::string_view message) const {
  throw Error::in_text(*file, attribute.line, attribute.column, message);
}
std::string Node::location() const {
  return *file + ":" + std::to_string(line) + ":" + std::to_string(column);
}

bool is_object_tag(std::string_view tag) {
  static constexpr std::array<std::string_view, 12> tags{"integrator", "sensor",  "sampler", "film",
                                                         "rfilter",    "emitter", "shape",   "bsdf",
                                                         "texture",    "medium",  "phase",   "volume"};
  return std::find(tags.begin(), tags.end(), tag) != tags.end();
}

const Node& Document::target(const Node& ref) const {
  const Attribute& id = ref.require("id");
  const auto found = ids.find(id.value);
  if (found != ids.end()) return *found->second;
  Names known;
  for (const auto& [name, node] : ids)
    known.push_back(name);
  ref.fail_at(id, "there is no object with the id " + in_quotes(id.value) + suggestion(id.value, known));
}

std::string Document::find_file(const Node& node, const std::string& name) const {
  const std::string beside = fs::path(*node.file).parent_path().string();
  Names all{beside.empty() ? "." : beside};
  for (const std::string& folder : folders)
    if (std::find(all.begin(), all.end(), folder) == all.end()) all.push_back(folder);
  try {
    return nacre::find_file(name, all);
  } catch (const Error& e) {
    node.fail(e.what());
  }
}

Document read_document(const std::string& text, const std::string& file,
                       const std::vector<std::string>& folders,
                       const std::map<std::string, std::string>& definitions) {
  Document document;
  Builder(document, folders, definitions).read(text, file);
  return document;
}

} // namespace nacre::mitsuba
