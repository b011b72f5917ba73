#include "measured/tensor_file.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <optional>

namespace nacre {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

constexpr std::array<char, 12> magic{'t', 'e', 'n', 's', 'o', 'r', '_', 'f', 'i', 'l', 'e', '\0'};
constexpr std::array<std::uint8_t, 2> version{1, 0};
constexpr std::array<std::string_view, 12> type_names{"",      "uint8",   "int8",    "uint16",
                                                      "int16", "uint32",  "int32",   "uint64",
                                                      "int64", "float16", "float32", "float64"};
constexpr std::array<std::size_t, 12> type_sizes{0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
constexpr std::size_t max_dimensions = 16;
constexpr std::size_t smallest_declaration = 2 + 2 + 1 + 8;

/// Takes little-endian numbers off the front.
class Cursor {
public:
  Cursor(std::span<const std::uint8_t> bytes, std::string_view file) : bytes_(bytes), file_(file) {}
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  std::span<const std::uint8_t> take(std::size_t n, std::string_view what) {
    if (left() < n)
      throw Error::in_binary(file_, bytes_.size(),
                             fmt::format("the file ends within {}, which needs {} byte{} from byte {}", what,
                                         n, n == 1 ? "" : "s", at_));
    at_ += n;
    return bytes_.subspan(at_ - n, n);
  }
  template <class T>
  T number(std::string_view what) {
    T x;
    std::memcpy(&x, take(sizeof(T), what).data(), sizeof(T));
    return x;
  }

private:
  std::span<const std::uint8_t> bytes_;
  std::string_view file_;
  std::size_t at_ = 0;
};

/// A name as it may be shown: what is not printable ASCII as \xNN.
std::string printable(std::span<const std::uint8_t> name) {
  std::string s;
  for (const std::uint8_t c : name.first(std::min<std::size_t>(name.size(), 64)))
    s += c >= 0x20 && c < 0x7f ? std::string(1, char(c)) : fmt::format("\\x{:02x}", c);
  return name.size() > 64 ? s + "..." : s;
}

/// Nothing where the product does not fit.
std::optional<std::uint64_t> byte_count(std::span<const std::uint64_t> shape, std::size_t element) {
  if (std::find(shape.begin(), shape.end(), 0u) != shape.end()) return 0;
  std::uint64_t n = element;
  for (const std::uint64_t size : shape) {
    if (n > std::numeric_limits<std::uint64_t>::max() / size) return std::nullopt;
    n *= size;
  }
  return n;
}

void check_overlaps(std::string_view file, std::span<const Tensor> fields) {
  std::vector<const Tensor*> order;
  for (const Tensor& f : fields)
    if (!f.bytes.empty()) order.push_back(&f);
  std::sort(order.begin(), order.end(), [](auto* a, auto* b) { return a->offset < b->offset; });
  for (std::size_t i = 1; i < order.size(); ++i)
    if (order[i]->offset < order[i - 1]->offset + order[i - 1]->bytes.size())
      throw Error::in_binary(
          file, order[i]->header_offset,
          fmt::format("data of field '{}' at byte {} overlaps that of '{}', which ends at byte {}",
                      order[i]->name, order[i]->offset, order[i - 1]->name,
                      order[i - 1]->offset + order[i - 1]->bytes.size()));
}

template <class T>
void append(std::vector<std::uint8_t>& bytes, const T& x) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T));
  std::memcpy(&bytes[at], &x, sizeof(T));
}

} // namespace

std::string_view to_text(TensorType type) { return type_names[std::size_t(type)]; }
std::size_t size_of(TensorType type) { return type_sizes[std::size_t(type)]; }
std::string to_text(std::span<const std::uint64_t> shape) {
  return fmt::format("{}", fmt::join(shape, " x "));
}

bool TensorFile::recognises(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

TensorFile TensorFile::parse(std::span<const std::uint8_t> bytes, std::string_view name) {
  Cursor in(bytes, name);
  if (!recognises(in.take(magic.size(), "the identifier")))
    throw Error::in_binary(name, 0,
                           "expected a tensor file, which begins with 'tensor_file' and a zero byte");
  const auto found = in.take(2, "the version");
  if (!std::equal(version.begin(), version.end(), found.begin()))
    throw Error::in_binary(name, 12,
                           fmt::format("version {}.{} of the tensor file, expected 1.0", found[0], found[1]));
  const auto count = in.number<std::uint32_t>("the number of fields");
  if (count > in.left() / smallest_declaration)
    throw Error::in_binary(
        name, 14, fmt::format("{} fields are declared, more than fit in {} bytes", count, in.left()));
  TensorFile file;
  file.name_ = name;
  for (std::uint32_t i = 0; i < count; ++i) {
    Tensor f;
    f.header_offset = in.at();
    const std::string which = fmt::format("the declaration of field {}", i + 1);
    const auto name_length = in.number<std::uint16_t>(which);
    f.name = printable(in.take(name_length, which));
    const auto dimensions = in.number<std::uint16_t>(which);
    const auto type = in.number<std::uint8_t>(which);
    f.offset = in.number<std::uint64_t>(which);
    const auto fail = [&](const std::string& message) {
      throw Error::in_binary(name, f.header_offset, fmt::format("field '{}': {}", f.name, message));
    };
    if (type < 1 || type >= type_sizes.size()) fail(fmt::format("type {}, expected 1 to 11", type));
    if (dimensions > max_dimensions)
      fail(fmt::format("{} dimensions, expected at most {}", dimensions, max_dimensions));
    f.type = TensorType(type);
    for (int d = 0; d < dimensions; ++d)
      f.shape.push_back(in.number<std::uint64_t>(which));
    const auto needed = byte_count(f.shape, size_of(f.type));
    if (f.offset > bytes.size() || !needed || *needed > bytes.size() - f.offset)
      fail(fmt::format("{} of shape {} at byte {} does not fit in the file's {} bytes",
                       nacre::to_text(f.type), nacre::to_text(f.shape), f.offset, bytes.size()));
    if (file.find(f.name)) fail("a second field of this name");
    f.bytes = bytes.subspan(f.offset, *needed);
    file.fields_.push_back(std::move(f));
  }
  file.end_of_header_ = in.at();
  for (const Tensor& f : file.fields_)
    if (!f.bytes.empty() && f.offset < file.end_of_header_)
      file.fail(f, fmt::format("data at byte {} lies in the header, which ends at byte {}", f.offset,
                               file.end_of_header_));
  check_overlaps(name, file.fields_);
  return file;
}

void TensorFile::fail(const Tensor& field, std::string_view message) const {
  throw Error::in_binary(name_, field.header_offset, fmt::format("field '{}': {}", field.name, message));
}

const Tensor* TensorFile::find(std::string_view name) const {
  for (const Tensor& f : fields_)
    if (f.name == name) return &f;
  return nullptr;
}

const Tensor& TensorFile::field(std::string_view name, TensorType type, std::size_t dimensions) const {
  const Tensor* f = find(name);
  if (!f) {
    std::vector<std::string> known;
    for (const Tensor& g : fields_)
      known.push_back(g.name);
    throw Error::in_binary(name_, end_of_header_,
                           fmt::format("no field '{}'{}", name, suggestion(name, known)));
  }
  if (f->type != type || f->shape.size() != dimensions)
    fail(*f, fmt::format("expected {} in {} dimension{}, found {} of shape {}", nacre::to_text(type),
                         dimensions, dimensions == 1 ? "" : "s", nacre::to_text(f->type),
                         f->shape.empty() ? "()" : nacre::to_text(f->shape)));
  return *f;
}

std::vector<float> TensorFile::floats(std::string_view name, std::size_t dimensions, bool allow_nan) const {
  const Tensor& f = field(name, TensorType::float32, dimensions);
  std::vector<float> values(f.bytes.size() / sizeof(float));
  if (!values.empty()) std::memcpy(values.data(), f.bytes.data(), f.bytes.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) && !(allow_nan && std::isnan(values[i])))
      throw Error::in_binary(name_, f.offset + i * sizeof(float),
                             fmt::format("field '{}': expected a finite number, found {}", name, values[i]));
  return values;
}

Tensor tensor(std::string name, std::vector<std::uint64_t> shape, std::span<const float> values) {
  return {std::move(name),
          TensorType::float32,
          std::move(shape),
          {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()}};
}
Tensor tensor(std::string name, std::string_view text) {
  return tensor(std::move(name), {text.size()},
                std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}
Tensor tensor(std::string name, std::vector<std::uint64_t> shape, std::span<const std::uint8_t> values) {
  return {std::move(name), TensorType::uint8, std::move(shape), values};
}

std::vector<std::uint8_t> encode_tensor_file(std::span<const Tensor> fields) {
  std::uint64_t offset = magic.size() + version.size() + sizeof(std::uint32_t);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Tensor& f = fields[i];
    if (byte_count(f.shape, size_of(f.type)) != f.bytes.size())
      throw Error(fmt::format("tensor '{}': {} bytes for {} of shape {}", f.name, f.bytes.size(),
                              to_text(f.type), to_text(f.shape)));
    if (f.name.size() > std::numeric_limits<std::uint16_t>::max() || f.shape.size() > max_dimensions)
      throw Error(
          fmt::format("tensor '{}': a longer name or more dimensions than the file can hold", f.name));
    for (std::size_t j = 0; j < i; ++j)
      if (fields[j].name == f.name) throw Error(fmt::format("two tensors of the name '{}'", f.name));
    offset += smallest_declaration + f.name.size() + 8 * f.shape.size();
  }
  const auto aligned = [](std::uint64_t x) { return (x + 7) / 8 * 8; };
  std::vector<std::uint8_t> bytes;
  append(bytes, magic);
  append(bytes, version);
  append(bytes, std::uint32_t(fields.size()));
  for (const Tensor& f : fields) {
    offset = aligned(offset);
    append(bytes, std::uint16_t(f.name.size()));
    bytes.insert(bytes.end(), f.name.begin(), f.name.end());
    append(bytes, std::uint16_t(f.shape.size()));
    append(bytes, std::uint8_t(f.type));
    append(bytes, offset);
    for (const std::uint64_t size : f.shape)
      append(bytes, size);
    offset += f.bytes.size();
  }
  for (const Tensor& f : fields) {
    bytes.resize(aligned(bytes.size()));
    bytes.insert(bytes.end(), f.bytes.begin(), f.bytes.end());
  }
  return bytes;
}

} // namespace nacre
