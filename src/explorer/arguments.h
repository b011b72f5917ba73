#pragma once
// What a request asks for, field by field, each checked.

#include "core/error.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>

namespace nacre {

/// The fields of a JSON object. Absent fields have a default or are an Error that names them.
class Arguments {
public:
  /// Keeps a reference.
  explicit Arguments(const nlohmann::json& object, std::string place = "") : object_(object), place_(place) {
    if (!object.is_object())
      throw Error(fmt::format("{}: expected an object", place_.empty() ? "message" : place_));
  }

  bool has(const char* name) const { return object_.contains(name) && !object_[name].is_null(); }
  const nlohmann::json& at(const char* name) const {
    if (!has(name)) throw Error(fmt::format("'{}{}' is missing", place_, name));
    return object_[name];
  }
  double number(const char* name, double otherwise, double lo, double hi) const {
    return has(name) ? number(name, lo, hi) : otherwise;
  }
  double number(const char* name, double lo, double hi) const {
    const auto& value = at(name);
    if (!value.is_number()) throw Error(fmt::format("'{}{}' is a number", place_, name));
    const double x = value.get<double>();
    if (!(x >= lo && x <= hi))
      throw Error(fmt::format("'{}{}' = {} lies outside [{}, {}]", place_, name, x, lo, hi));
    return x;
  }
  int whole(const char* name, int otherwise, int lo, int hi) const {
    const double x = number(name, otherwise, lo, hi);
    if (x != std::floor(x)) throw Error(fmt::format("'{}{}' = {} is no whole number", place_, name, x));
    return int(x);
  }
  /// A name, or some words.
  std::string text(const char* name) const {
    std::string value = long_text(name);
    constexpr std::size_t longest = 64 << 10;
    if (value.size() > longest)
      throw Error(fmt::format("'{}{}' has {} bytes, more than {}", place_, name, value.size(), longest));
    return value;
  }
  /// What a file may hold.
  std::string long_text(const char* name) const {
    const auto& value = at(name);
    if (!value.is_string()) throw Error(fmt::format("'{}{}' is a text", place_, name));
    return value.get<std::string>();
  }
  std::string text(const char* name, const std::string& otherwise) const {
    return has(name) ? text(name) : otherwise;
  }
  bool truth(const char* name, bool otherwise) const {
    if (!has(name)) return otherwise;
    if (!object_[name].is_boolean()) throw Error(fmt::format("'{}{}' is true or false", place_, name));
    return object_[name].get<bool>();
  }
  Arguments object(const char* name) const { return Arguments(at(name), place_ + name + "."); }
  const nlohmann::json& list(const char* name, std::size_t most) const {
    const auto& value = at(name);
    if (!value.is_array()) throw Error(fmt::format("'{}{}' is a list", place_, name));
    if (value.size() > most)
      throw Error(fmt::format("'{}{}' has {} entries, more than {}", place_, name, value.size(), most));
    return value;
  }
  double angle(const char* name, double otherwise, double lo = -720, double hi = 720) const {
    return number(name, otherwise, lo, hi);
  }

private:
  const nlohmann::json& object_;
  std::string place_;
};

} // namespace nacre
