#include "measured/formats/nbrdf.h"

#include "core/error.h"
#include "core/file.h"
#include "measured/formats/hdf5_writer.h"
#include "measured/hdf5_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <map>

namespace nacre {

static_assert(std::endian::native == std::endian::little, "numbers are stored little-endian");

namespace {

constexpr std::string_view kernel_ending = "/kernel:0", bias_ending = "/bias:0";

/// The number at the end of a layer's name, "dense_3" -> 3; 0 for "dense", which Keras counts from.
int number_of(std::string_view group) {
  const std::size_t digits = group.find_last_not_of("0123456789") + 1;
  int n = 0;
  std::from_chars(group.data() + digits, group.data() + group.size(), n);
  return n;
}

/// Names of layers in their order from an attribute of fixed-length texts.
std::vector<std::string> names_in_order(const Hdf5File& file) {
  for (const char* where : {"@layer_names", "model_weights@layer_names"}) {
    const auto found = file.attributes().find(where);
    if (found == file.attributes().end()) continue;
    const Hdf5File::Array& a = found->second;
    if (a.type != Hdf5File::Type::text || !a.unreadable.empty()) continue;
    std::vector<std::string> names;
    for (std::uint64_t i = 0; i < a.size(); ++i) {
      const auto text = a.bytes.subspan(i * a.element_bytes, a.element_bytes);
      names.emplace_back(text.begin(), std::find(text.begin(), text.end(), 0));
    }
    return names;
  }
  return {};
}

NeuralBrdf network_of(const std::vector<NeuralBrdf::Layer>& layers, std::string_view name) {
  try {
    return NeuralBrdf(layers);
  } catch (const Error& e) {
    throw Error::in_file(name, e.what());
  }
}

/// One array of a `.npy` file.
struct NumpyArray {
  std::size_t offset = 0; ///< where it begins
  std::vector<std::size_t> shape;
  std::vector<float> values;
};

class NumpyReader {
public:
  NumpyReader(std::span<const std::uint8_t> bytes, std::string_view name) : bytes_(bytes), name_(name) {}

  bool at_end() const { return at_ == bytes_.size(); }

  NumpyArray next() {
    constexpr std::array<std::uint8_t, 6> magic{0x93, 'N', 'U', 'M', 'P', 'Y'};
    NumpyArray a;
    a.offset = at_;
    need(10, "a header");
    if (!std::equal(magic.begin(), magic.end(), bytes_.begin() + std::ptrdiff_t(at_)))
      fail("expected an array of NumPy, which begins with \\x93NUMPY");
    const unsigned version = bytes_[at_ + 6];
    if (version < 1 || version > 3) fail(fmt::format("NumPy format {}, expected 1 to 3", version));
    std::size_t header = bytes_[at_ + 8] + 256u * bytes_[at_ + 9], head = 10;
    if (version > 1) {
      need(12, "a header");
      header += (std::size_t(bytes_[at_ + 10]) << 16) + (std::size_t(bytes_[at_ + 11]) << 24);
      head = 12;
    }
    at_ += head;
    need(header, "a header");
    if (header > 65536) fail(fmt::format("a header of {} bytes", header));
    const std::string text(bytes_.begin() + std::ptrdiff_t(at_),
                           bytes_.begin() + std::ptrdiff_t(at_ + header));
    const std::string type = value_of(text, "descr");
    const bool single = type == "'<f4'";
    if (!single && type != "'<f8'")
      fail(fmt::format("type {}, expected '<f4' or '<f8' (little-endian floats)", type));
    const bool columns_first = value_of(text, "fortran_order") == "True";
    a.shape = shape_of(value_of(text, "shape"));
    at_ += header;
    std::size_t count = 1;
    for (const std::size_t n : a.shape) {
      if (n < 1 || n > bytes_.size() || count > bytes_.size() / n)
        fail("an array larger than the file, or empty");
      count *= n;
    }
    const std::size_t element = single ? 4 : 8;
    if (count > (bytes_.size() - at_) / element)
      fail(fmt::format("{} numbers of {} bytes expected, the file ends at byte {}", count, element,
                       bytes_.size()));
    a.values.resize(count);
    const std::size_t rows = a.shape.size() == 2 ? a.shape[0] : count, columns = count / rows;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t to = columns_first ? i % rows * columns + i / rows : i;
      double x;
      if (single) {
        float y;
        std::memcpy(&y, &bytes_[at_ + i * element], sizeof y);
        x = double(y);
      } else {
        std::memcpy(&x, &bytes_[at_ + i * element], sizeof x);
      }
      a.values[to] = float(x);
      if (!std::isfinite(a.values[to])) {
        at_ += i * element;
        fail(fmt::format("expected finite numbers, found {}", x));
      }
    }
    at_ += count * element;
    return a;
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw Error::in_binary(name_, at_, what); }
  void need(std::size_t size, const char* what) const {
    if (size > bytes_.size() - at_) fail(fmt::format("{} of {} bytes reaches beyond the file", what, size));
  }
  /// What stands behind 'key': in the header, a Python dictionary; commas within brackets belong to it.
  std::string value_of(const std::string& text, const std::string& key) const {
    const std::size_t found = text.find("'" + key + "'");
    const std::size_t colon = found == std::string::npos ? found : text.find(':', found);
    if (colon == std::string::npos) fail(fmt::format("the header names no '{}'", key));
    const std::size_t begin = text.find_first_not_of(' ', colon + 1);
    if (begin == std::string::npos) fail(fmt::format("the header gives no '{}'", key));
    if (text[begin] == '(') return text.substr(begin, text.find(')', begin) + 1 - begin);
    const std::size_t end = text.find_first_of(",}", begin);
    return text.substr(begin, end == std::string::npos ? end : end - begin);
  }
  std::vector<std::size_t> shape_of(const std::string& text) const {
    std::vector<std::size_t> shape;
    for (const char *p = text.data(), *end = p + text.size(); p < end;) {
      if (*p < '0' || *p > '9') {
        ++p;
        continue;
      }
      std::size_t n = 0;
      const auto [after, error] = std::from_chars(p, end, n);
      if (error != std::errc() || shape.size() == 2)
        fail(fmt::format("shape {}, expected one or two dimensions", text));
      shape.push_back(n);
      p = after;
    }
    if (shape.empty()) fail(fmt::format("shape {}, expected one or two dimensions", text));
    return shape;
  }

  std::span<const std::uint8_t> bytes_;
  std::string_view name_;
  std::size_t at_ = 0;
};

} // namespace

NeuralBrdf parse_nbrdf_h5(std::span<const std::uint8_t> bytes, std::string_view name) {
  const Hdf5File file(bytes, name);
  std::vector<std::string> groups;
  for (const auto& [path, unused] : file.arrays())
    if (path.ends_with(kernel_ending)) groups.push_back(path.substr(0, path.size() - kernel_ending.size()));
  if (groups.empty() || groups.size() > NeuralBrdf::max_layers)
    throw Error::in_file(
        name, fmt::format("expected a network's weights, 1 to {} arrays that end in '{}', found {}",
                          NeuralBrdf::max_layers, kernel_ending, groups.size()));
  const std::vector<std::string> order = names_in_order(file);
  const auto place = [&](const std::string& group) {
    // "dense_1/dense_1" or "model_weights/dense_1/dense_1"
    const std::string last = group.substr(group.find_last_of('/') + 1);
    return std::pair{std::find(order.begin(), order.end(), last) - order.begin(), number_of(last)};
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const std::string& a, const std::string& b) { return place(a) < place(b); });
  std::vector<NeuralBrdf::Layer> layers;
  for (const std::string& group : groups) {
    const std::string kernel = group + std::string(kernel_ending);
    const auto& shape = file.array(kernel).shape;
    if (shape.size() != 2)
      throw Error::in_binary(name, file.array(kernel).offset,
                             fmt::format("array '{}' has {} dimensions, expected 2", kernel, shape.size()));
    layers.push_back({std::size_t(shape[0]), std::size_t(shape[1]), file.floats(kernel),
                      file.floats(group + std::string(bias_ending))});
  }
  return network_of(layers, name);
}

NeuralBrdf parse_nbrdf_npy(std::span<const std::uint8_t> bytes, std::string_view name) {
  NumpyReader reader(bytes, name);
  std::vector<NeuralBrdf::Layer> layers;
  do {
    const NumpyArray kernel = reader.next();
    if (kernel.shape.size() != 2)
      throw Error::in_binary(name, kernel.offset,
                             "expected the kernel of a layer, an array of two dimensions (inputs x outputs)");
    if (reader.at_end())
      throw Error::in_binary(
          name, bytes.size(),
          "expected the bias that follows a kernel; the six arrays of a network are "
          "MATERIAL_fc1.npy, MATERIAL_b1.npy to MATERIAL_b3.npy, or lie in one file in that order");
    NumpyArray bias = reader.next();
    if (bias.shape.size() != 1)
      throw Error::in_binary(name, bias.offset, "expected the bias of a layer, an array of one dimension");
    if (layers.size() == NeuralBrdf::max_layers)
      throw Error::in_binary(name, kernel.offset, fmt::format("more than {} layers", NeuralBrdf::max_layers));
    layers.push_back({kernel.shape[0], kernel.shape[1], kernel.values, std::move(bias.values)});
  } while (!reader.at_end());
  return network_of(layers, name);
}

std::vector<std::uint8_t> read_nbrdf_npy_files(const std::string& path) {
  const std::filesystem::path file(path);
  const std::string stem = file.stem().string(), ending = file.extension().string();
  for (const char* part : {"fc1", "b1", "fc2", "b2", "fc3", "b3"}) {
    const std::string tail = part;
    if (!stem.ends_with(tail)) continue;
    const std::string material = stem.substr(0, stem.size() - tail.size());
    if (!material.empty() && material.back() != '_') continue;
    std::vector<std::uint8_t> all;
    for (const char* each : {"fc1", "b1", "fc2", "b2", "fc3", "b3"}) {
      const auto bytes = read_file((file.parent_path() / (material + each + ending)).string());
      all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
  }
  return read_file(path);
}

std::vector<std::uint8_t> encode_nbrdf_h5(const NeuralBrdf& network) {
  Hdf5Writer file;
  for (std::size_t l = 0; l < network.layers().size(); ++l) {
    const NeuralBrdf::Layer& layer = network.layers()[l];
    const std::string name = fmt::format("dense_{}", l + 1), group = name + "/" + name;
    file.group(name);
    file.group(group);
    const std::array<std::uint64_t, 2> shape{layer.inputs, layer.outputs};
    file.array(group + std::string(kernel_ending), shape, layer.kernel.data());
    file.array(group + std::string(bias_ending), std::span(shape).last(1), layer.bias.data());
  }
  return file.finish();
}

std::vector<std::uint8_t> encode_nbrdf_npy(const NeuralBrdf& network) {
  std::vector<std::uint8_t> bytes;
  const auto append = [&](const std::string& shape, const std::vector<float>& values) {
    // Version 1.0: magic, version, length of a header that ends in a line break and is padded so that the
    // data begin at a multiple of 64 bytes.
    std::string header = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}), }}", shape);
    header.resize((10 + header.size() + 1 + 63) / 64 * 64 - 10 - 1, ' ');
    header += '\n';
    constexpr std::array<std::uint8_t, 8> begin{0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
    bytes.insert(bytes.end(), begin.begin(), begin.end());
    bytes.push_back(std::uint8_t(header.size() & 255));
    bytes.push_back(std::uint8_t(header.size() >> 8));
    bytes.insert(bytes.end(), header.begin(), header.end());
    const std::size_t at = bytes.size();
    bytes.resize(at + values.size() * sizeof(float));
    std::memcpy(&bytes[at], values.data(), values.size() * sizeof(float));
  };
  for (const NeuralBrdf::Layer& layer : network.layers()) {
    append(fmt::format("{}, {}", layer.inputs, layer.outputs), layer.kernel);
    append(fmt::format("{},", layer.outputs), layer.bias);
  }
  return bytes;
}

} // namespace nacre
