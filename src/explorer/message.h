#pragma once
// What the core sends: a JSON header and arrays of numbers beside it.

#include "core/image.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace nacre {

/// Row-major, the last index fastest.
struct NamedArray {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<float> data; ///< as many as the shape says
};

/// The answer of a request, without its id.
struct Answer {
  nlohmann::json header = nlohmann::json::object();
  std::vector<NamedArray> arrays;

  /// @throws std::logic_error where data and shape disagree
  void add(std::string name, std::vector<std::size_t> shape, std::vector<float> data);
  /// [height, width, 3] of the channels R, G, B.
  void add_image(std::string name, const Image& image);
};

/// As it travels: a text or a binary message.
struct Message {
  bool is_binary = false;
  std::string bytes;
};

} // namespace nacre
