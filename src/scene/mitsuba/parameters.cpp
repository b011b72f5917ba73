#include "scene/mitsuba/parameters.h"

#include "core/error.h"
#include "core/text_scanner.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace nacre::mitsuba {
namespace {

bool is_separator(char c) { return c == ' ' || c == ',' || c == '\t' || c == '\n' || c == '\r'; }

double read_number_of(const Node& node, const Attribute& attribute, std::string_view token) {
  double value = 0;
  if (!parse_number(token, value)) node.fail_at(attribute, "expected a number, found " + in_quotes(token));
  if (!std::isfinite(value)) node.fail_at(attribute, "expected a finite number, found " + in_quotes(token));
  return value;
}

/// x, y and z, each as an attribute or all in `value`.
Vec3d read_xyz(const Node& node, double initial) {
  if (const Attribute* value = node.find("value")) {
    if (node.find("x") != nullptr || node.find("y") != nullptr || node.find("z") != nullptr)
      node.fail_at(*value, "'value' and 'x', 'y', 'z' exclude each other");
    const auto v = read_numbers(node, *value);
    if (v.size() == 1 && node.tag == "scale") return {v[0], v[0], v[0]};
    if (v.size() != 3) node.fail_at(*value, "expected three numbers, found " + std::to_string(v.size()));
    return {v[0], v[1], v[2]};
  }
  const auto get = [&](std::string_view name) {
    const Attribute* a = node.find(name);
    return a == nullptr ? initial : read_number(node, *a);
  };
  return {get("x"), get("y"), get("z")};
}

Vec3d read_triple(const Node& node, const Attribute& attribute) {
  const auto v = read_numbers(node, attribute);
  if (v.size() != 3) node.fail_at(attribute, "expected three numbers, found " + std::to_string(v.size()));
  return {v[0], v[1], v[2]};
}

Transform read_matrix(const Node& node) {
  const Attribute& value = node.require("value");
  const auto v = read_numbers(node, value);
  Transform t;
  if (v.size() == 16) {
    for (int i = 0; i < 16; ++i)
      t.m[i / 4][i % 4] = v[i];
    if (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1)
      node.fail_at(value, "the last row of the matrix must be 0 0 0 1: projections are not supported");
  } else if (v.size() == 9) {
    for (int i = 0; i < 9; ++i)
      t.m[i / 3][i % 3] = v[i];
  } else {
    node.fail_at(value, "expected 16 or 9 numbers, found " + std::to_string(v.size()));
  }
  return t;
}

Transform read_step(const Node& node) {
  if (node.tag == "translate") return Transform::translate(read_xyz(node, 0));
  if (node.tag == "scale") return Transform::scale(read_xyz(node, 1));
  if (node.tag == "matrix") return read_matrix(node);
  if (node.tag == "rotate")
    return Transform::rotate(read_xyz(node, 0), read_number(node, node.require("angle")));
  if (node.tag != "lookat")
    node.fail("expected translate, rotate, scale, lookat or matrix, found <" + node.tag + ">");
  const Vec3d origin = read_triple(node, node.require("origin")),
              target = read_triple(node, node.require("target"));
  if (const Attribute* up = node.find("up"))
    return Transform::look_at(origin, target, read_triple(node, *up));
  return Transform::look_at(origin, target, Frame<double>::around(normalize(target - origin)).s);
}

} // namespace

std::vector<double> read_numbers(const Node& node, const Attribute& attribute) {
  std::vector<double> numbers;
  const std::string& text = attribute.value;
  for (std::size_t i = 0; i < text.size();) {
    if (is_separator(text[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && !is_separator(text[end]))
      ++end;
    numbers.push_back(read_number_of(node, attribute, std::string_view(text).substr(i, end - i)));
    i = end;
  }
  return numbers;
}

double read_number(const Node& node, const Attribute& attribute) {
  const auto v = read_numbers(node, attribute);
  if (v.size() != 1) node.fail_at(attribute, "expected one number, found " + in_quotes(attribute.value));
  return v[0];
}

Transform read_transform(const Node& node) {
  Transform result;
  for (const Node& child : node.children) {
    try {
      result = read_step(child) * result;
    } catch (const Error& e) {
      // What Transform itself rejects has no place yet.
      if (std::string_view(e.what()).starts_with(*child.file)) throw;
      child.fail(e.what());
    }
  }
  for (const auto& row : result.m)
    for (const double v : row)
      if (!std::isfinite(v)) node.fail("the transform leaves the range of numbers");
  return result;
}

Parameters::Parameters(const Node& node, const Document& document) : node_(node), document_(document) {
  if (is_object_tag(node.tag) || node.tag == "spectrum") type_ = node.require("type").value;
  for (const Node& child : node.children) {
    if (child.tag == "alias") continue;
    const bool is_ref = child.tag == "ref";
    if (!is_ref && !is_object_tag(child.tag) && child.find("name") == nullptr)
      child.fail("<" + child.tag + "> in <" + node.tag + "> lacks the attribute 'name'");
    if (child.tag == "scene") child.fail("<scene> cannot be nested");
    const std::string_view name = child.get("name");
    for (const Entry& other : entries_)
      if (!name.empty() && other.written->get("name") == name)
        child.fail("the parameter " + in_quotes(name) + " is given twice: see " + other.written->location());
    entries_.push_back({&child, is_ref ? &document.target(child) : &child});
  }
}

Parameters::Entry* Parameters::entry(std::string_view name) {
  asked_.emplace(name);
  for (Entry& e : entries_)
    if (e.written->get("name") == name) return &e;
  return nullptr;
}

bool Parameters::has(std::string_view name) {
  for (const Entry& e : entries_)
    if (e.written->get("name") == name) return true;
  asked_.emplace(name);
  return false;
}

const Node* Parameters::find(std::string_view name) {
  Entry* e = entry(name);
  if (e == nullptr) return nullptr;
  e->used = true;
  return e->resolved;
}

const Node& Parameters::at(std::string_view name) const {
  for (const Entry& e : entries_)
    if (e.written->get("name") == name) return *e.written;
  return node_;
}

const Node* Parameters::typed(std::string_view name, std::initializer_list<std::string_view> tags) {
  const Node* found = find(name);
  if (found == nullptr || std::find(tags.begin(), tags.end(), found->tag) != tags.end()) return found;
  std::string wanted;
  for (const auto tag : tags)
    wanted += (wanted.empty() ? "<" : " or <") + std::string(tag) + ">";
  at(name).fail("the parameter '" + std::string(name) + "' must be " + wanted + ", found <" + found->tag +
                ">");
}

double Parameters::number(std::string_view name, double initial) {
  const Node* n = typed(name, {"float", "integer"});
  return n == nullptr ? initial : read_number(*n, n->require("value"));
}

int Parameters::integer(std::string_view name, int initial) {
  const Node* n = typed(name, {"integer"});
  if (n == nullptr) return initial;
  const double v = read_number(*n, n->require("value"));
  if (v != std::floor(v) || std::abs(v) > std::numeric_limits<int>::max())
    n->fail_at(n->require("value"), "expected an integer, found " + in_quotes(n->get("value")));
  return static_cast<int>(v);
}

bool Parameters::boolean(std::string_view name, bool initial) {
  const Node* n = typed(name, {"boolean"});
  if (n == nullptr) return initial;
  const std::string& v = n->require("value").value;
  if (v == "true" || v == "True" || v == "1") return true;
  if (v == "false" || v == "False" || v == "0") return false;
  n->fail_at(n->require("value"), "expected true or false, found " + in_quotes(v));
}

std::string Parameters::text(std::string_view name, std::string_view initial) {
  const Node* n = typed(name, {"string"});
  return n == nullptr ? std::string(initial) : n->require("value").value;
}

std::string Parameters::choice(std::string_view name, std::string_view initial,
                               std::initializer_list<std::string> choices) {
  const std::string value = text(name, initial);
  const std::vector<std::string> known(choices);
  if (std::find(known.begin(), known.end(), value) == known.end())
    at(name).fail("the parameter '" + std::string(name) + "' cannot be " + in_quotes(value) +
                  suggestion(value, known));
  return value;
}

std::string Parameters::file(std::string_view name) {
  const std::string value = text(name, "");
  if (value.empty())
    node_.fail(node_.tag + " '" + type_ + "' lacks the parameter '" + std::string(name) + "'");
  return document_.find_file(at(name), value);
}

std::string Parameters::file_named_in(std::string_view name, const std::string& file) {
  return document_.find_file(at(name), file);
}

std::optional<Vec3d> Parameters::vector(std::string_view name) {
  const Node* n = typed(name, {"point", "vector"});
  if (n == nullptr) return std::nullopt;
  return read_xyz(*n, 0);
}

Transform Parameters::transform(std::string_view name) {
  const Node* n = typed(name, {"transform"});
  if (n == nullptr) return {};
  const Transform transform = read_transform(*n);
  // Lengths are squared in single precision, which ends at 3.4e38.
  constexpr double largest = 1e18;
  for (const auto& row : transform.m)
    for (const double x : row)
      if (!(std::abs(x) <= largest))
        n->fail(
            fmt::format("'{}' moves or scales by more than {:g}, too far for the renderer", name, largest));
  return transform;
}

std::vector<const Node*> Parameters::objects(std::string_view tag) {
  std::vector<const Node*> found;
  for (Entry& e : entries_)
    if (!e.used && e.resolved->tag == tag) {
      e.used = true;
      found.push_back(e.resolved);
    }
  return found;
}

void Parameters::ignore(std::initializer_list<std::string_view> names) {
  for (const auto name : names)
    find(name);
}

void Parameters::finish() const {
  const std::vector<std::string> known(asked_.begin(), asked_.end());
  for (const Entry& e : entries_) {
    if (e.used) continue;
    const std::string_view name = e.written->get("name");
    const std::string owner = node_.tag + (type_.empty() ? "" : " '" + type_ + "'");
    if (name.empty() ||
        (is_object_tag(e.resolved->tag) && asked_.count(std::string(name)) == 0 && known.empty()))
      e.written->fail(owner + " takes no nested <" + e.resolved->tag + ">");
    e.written->fail(owner + " has no parameter " + in_quotes(name) + suggestion(name, known));
  }
}

} // namespace nacre::mitsuba
