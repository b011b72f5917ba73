#include "measured/hdf5_file.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <set>

namespace nacre {

static_assert(std::endian::native == std::endian::little, "numbers are stored little-endian");

namespace {

constexpr std::array<std::uint8_t, 8> signature{0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
constexpr std::uint64_t undefined_address = ~std::uint64_t(0);
constexpr std::size_t most_objects = 10000; ///< arrays, groups and attributes together
constexpr int deepest_group = 32, deepest_tree = 16;
constexpr int most_dimensions = 8;

std::uint64_t rounded_up_to_8(std::uint64_t n) { return (n + 7) / 8 * 8; }

} // namespace

/// Follows the addresses of one file.
class Hdf5Walk {
public:
  Hdf5Walk(std::span<const std::uint8_t> bytes, Hdf5File& file) : bytes_(bytes), file_(file) {}

  void superblock() {
    if (bytes_.size() < signature.size() || !Hdf5File::recognises(bytes_))
      fail(0, "expected the signature of an HDF5 file");
    const unsigned version = number<std::uint8_t>(8);
    if (version > 1)
      fail(8, fmt::format(
                  "superblock of version {}, expected 0 or 1 (h5repack --low=0 --high=0, or h5py without "
                  "libver, writes those)",
                  version));
    if (number<std::uint8_t>(13) != 8 || number<std::uint8_t>(14) != 8)
      fail(13, "expected offsets and lengths of 8 bytes");
    const std::uint64_t after = version == 0 ? 24 : 28;
    if (number<std::uint64_t>(after) != 0) fail(after, "expected base address 0");
    const auto end = number<std::uint64_t>(after + 16);
    if (end > bytes_.size())
      fail(bytes_.size(), fmt::format("the file ends here, its header promises {} bytes", end));
    const std::uint64_t root = number<std::uint64_t>(after + 32 + 8);
    object(root, "", 0, after + 32 + 8);
  }

private:
  struct Message {
    unsigned type;
    std::uint64_t offset, size;
  };

  [[noreturn]] void fail(std::uint64_t offset, const std::string& what) const {
    throw Error::in_binary(file_.name_, offset, what);
  }
  /// @throws Error unless [offset, offset + size) lies in the file
  void need(std::uint64_t offset, std::uint64_t size, std::string_view what) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset)
      fail(std::min<std::uint64_t>(offset, bytes_.size()),
           fmt::format("{} of {} bytes reaches beyond the {} bytes of the file", what, size, bytes_.size()));
  }
  template <class T>
  T number(std::uint64_t offset) const {
    need(offset, sizeof(T), "a number");
    T x;
    std::memcpy(&x, bytes_.data() + offset, sizeof(T));
    return x;
  }
  void expect_magic(std::uint64_t offset, const char* magic) const {
    need(offset, 4, "a block");
    if (std::memcmp(bytes_.data() + offset, magic, 4) != 0)
      fail(offset, fmt::format("expected a block that begins with {}", magic));
  }
  void count_object(std::uint64_t offset) {
    if (++objects_ > most_objects) fail(offset, fmt::format("more than {} objects", most_objects));
  }

  std::vector<Message> messages(std::uint64_t address) {
    if (const unsigned version = number<std::uint8_t>(address); version != 1)
      fail(address, fmt::format("object header of version {}, expected 1", version));
    const unsigned count = number<std::uint16_t>(address + 2);
    std::vector<Message> found;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> blocks{
        {address + 16, number<std::uint32_t>(address + 8)}};
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      auto [at, left] = blocks[b];
      need(at, left, "an object header");
      while (left >= 8 && found.size() < count) {
        const Message m{number<std::uint16_t>(at), at + 8, number<std::uint16_t>(at + 2)};
        if (m.size > left - 8)
          fail(at, fmt::format("a message of {} bytes where {} are left", m.size, left - 8));
        if ((number<std::uint8_t>(at + 4) & 2) != 0 && (m.type == 1 || m.type == 3))
          fail(at, "a shared message, which this reader does not follow");
        if (m.type == 0x10) {
          need(m.offset, 16, "a continuation");
          if (blocks.size() > 64) fail(at, "an object header in more than 64 pieces");
          blocks.emplace_back(number<std::uint64_t>(m.offset), number<std::uint64_t>(m.offset + 8));
        }
        found.push_back(m);
        at += 8 + m.size;
        left -= 8 + m.size;
      }
    }
    return found;
  }

  void object(std::uint64_t address, const std::string& path, int depth, std::uint64_t from) {
    count_object(from);
    if (depth > deepest_group) fail(from, fmt::format("groups nested deeper than {}", deepest_group));
    if (!open_.insert(address).second) fail(from, "a group that contains itself");
    const auto all = messages(address);
    const auto first = [&](unsigned type) -> std::optional<Message> {
      for (const Message& m : all)
        if (m.type == type) return m;
      return std::nullopt;
    };
    for (const Message& m : all)
      if (m.type == 0x0c) attribute(m, path);
    if (const auto table = first(0x11)) {
      need(table->offset, 16, "a symbol table");
      const auto tree = number<std::uint64_t>(table->offset), heap = number<std::uint64_t>(table->offset + 8);
      group_tree(tree, heap, path, depth, 0);
    } else if (const auto layout = first(8)) {
      Hdf5File::Array a;
      shape_and_type(a, first(1), first(3));
      data(a, *layout, first(0x0b).has_value());
      file_.arrays_[path] = std::move(a);
    } else if (first(2) || first(6)) {
      fail(address, "a group of the newer kind (links in messages), expected a symbol table");
    }
    open_.erase(address);
  }

  void group_tree(std::uint64_t address, std::uint64_t heap, const std::string& path, int depth, int level) {
    expect_magic(address, "TREE");
    if (level > deepest_tree) fail(address, "a tree of groups that is too deep");
    count_object(address);
    const unsigned type = number<std::uint8_t>(address + 4), height = number<std::uint8_t>(address + 5),
                   used = number<std::uint16_t>(address + 6);
    if (type != 0) fail(address + 4, "expected a tree of group entries");
    need(address + 24, 16 * std::uint64_t(used) + 8, "a tree node");
    for (unsigned i = 0; i < used; ++i) {
      const auto child = number<std::uint64_t>(address + 32 + 16 * std::uint64_t(i));
      if (height > 0)
        group_tree(child, heap, path, depth, level + 1);
      else
        symbols(child, heap, path, depth);
    }
  }

  void symbols(std::uint64_t address, std::uint64_t heap, const std::string& path, int depth) {
    expect_magic(address, "SNOD");
    const unsigned count = number<std::uint16_t>(address + 6);
    need(address + 8, 40 * std::uint64_t(count), "a symbol node");
    for (unsigned i = 0; i < count; ++i) {
      const std::uint64_t entry = address + 8 + 40 * std::uint64_t(i);
      const std::string name = heap_text(heap, number<std::uint64_t>(entry), entry);
      if (number<std::uint32_t>(entry + 16) == 2) continue; // a symbolic link
      object(number<std::uint64_t>(entry + 8), path.empty() ? name : path + "/" + name, depth + 1, entry + 8);
    }
  }

  std::string heap_text(std::uint64_t heap, std::uint64_t at, std::uint64_t from) const {
    expect_magic(heap, "HEAP");
    const auto size = number<std::uint64_t>(heap + 8), data = number<std::uint64_t>(heap + 24);
    need(data, size, "a heap of names");
    if (at >= size) fail(from, "a name outside its heap");
    const auto* begin = bytes_.data() + data + at;
    const auto* end = std::find(begin, begin + std::min<std::uint64_t>(size - at, 1024), 0);
    if (end == begin + (size - at) || *end != 0) fail(data + at, "a name that does not end");
    return {begin, end};
  }

  /// How many bytes of a dataspace and datatype there are is `size`, or what the message has.
  void shape_and_type(Hdf5File::Array& a, const std::optional<Message>& space,
                      const std::optional<Message>& type) const {
    if (!space || !type) {
      a.unreadable = "it has no shape or no type";
      return;
    }
    shape(a, *space);
    datatype(a, *type);
  }

  void shape(Hdf5File::Array& a, const Message& m) const {
    need(m.offset, 4, "a shape");
    const unsigned version = number<std::uint8_t>(m.offset), rank = number<std::uint8_t>(m.offset + 1);
    if (version != 1 && version != 2) fail(m.offset, fmt::format("a shape of version {}", version));
    if (rank > most_dimensions) fail(m.offset + 1, fmt::format("an array of {} dimensions", rank));
    const std::uint64_t head = version == 1 ? 8 : 4;
    if (m.size < head + 8 * std::uint64_t(rank)) fail(m.offset, "a shape that does not fit its message");
    std::uint64_t count = 1;
    for (unsigned d = 0; d < rank; ++d) {
      const auto n = number<std::uint64_t>(m.offset + head + 8 * std::uint64_t(d));
      if (n > bytes_.size() || (n > 0 && count > bytes_.size() / n))
        fail(m.offset + head + 8 * std::uint64_t(d), "an array larger than the file");
      count *= n;
      a.shape.push_back(n);
    }
    if (version == 2 && number<std::uint8_t>(m.offset + 3) == 2) a.unreadable = "it is empty";
  }

  void datatype(Hdf5File::Array& a, const Message& m) const {
    if (m.size < 8) fail(m.offset, "a type that does not fit its message");
    const unsigned kind = number<std::uint8_t>(m.offset) & 15u, bits = number<std::uint8_t>(m.offset + 1);
    a.element_bytes = number<std::uint32_t>(m.offset + 4);
    if (a.element_bytes == 0 || a.element_bytes > bytes_.size())
      fail(m.offset + 4, fmt::format("elements of {} bytes", a.element_bytes));
    const bool big_endian = (bits & 1) != 0;
    using T = Hdf5File::Type;
    if (kind == 3)
      a.type = T::text;
    else if (kind == 1 && !big_endian && a.element_bytes == 4)
      a.type = T::float32;
    else if (kind == 1 && !big_endian && a.element_bytes == 8)
      a.type = T::float64;
    else if (kind == 0 && (!big_endian || a.element_bytes == 1)) {
      const bool is_signed = (bits & 8) != 0;
      switch (a.element_bytes) {
      case 1:
        a.type = is_signed ? T::int8 : T::uint8;
        break;
      case 4:
        a.type = is_signed ? T::int32 : T::uint32;
        break;
      case 8:
        a.type = is_signed ? T::int64 : T::uint64;
        break;
      default:
        break;
      }
    }
  }

  void data(Hdf5File::Array& a, const Message& m, bool filtered) const {
    if (!a.unreadable.empty()) return;
    const unsigned version = number<std::uint8_t>(m.offset), kind = number<std::uint8_t>(m.offset + 1);
    if (version != 3) {
      a.unreadable = fmt::format("its layout is of version {}, expected 3", version);
      return;
    }
    if (kind > 1 || filtered) {
      a.unreadable = "it is stored in chunks or compressed, expected one piece (h5repack -l CONTI -f NONE)";
      return;
    }
    // size() <= the file's bytes, and element_bytes too: no overflow.
    const std::uint64_t count = a.size();
    if (count > bytes_.size() / a.element_bytes) fail(m.offset, "an array larger than the file");
    std::uint64_t stored;
    if (kind == 0) {
      stored = number<std::uint16_t>(m.offset + 2);
      a.offset = m.offset + 4;
    } else {
      a.offset = number<std::uint64_t>(m.offset + 2);
      stored = number<std::uint64_t>(m.offset + 10);
    }
    const std::uint64_t wanted = count * a.element_bytes;
    if (wanted == 0) return;
    if (kind == 1 && a.offset == undefined_address) {
      a.unreadable = "nothing was ever written to it";
      return;
    }
    if (stored != wanted)
      fail(m.offset, fmt::format("an array of {} bytes by its shape, {} by its layout", wanted, stored));
    need(a.offset, wanted, "an array");
    a.bytes = bytes_.subspan(a.offset, wanted);
  }

  void attribute(const Message& m, const std::string& path) {
    count_object(m.offset);
    if (m.size < 8) fail(m.offset, "an attribute that does not fit its message");
    const unsigned version = number<std::uint8_t>(m.offset);
    if (version < 1 || version > 3) fail(m.offset, fmt::format("an attribute of version {}", version));
    const std::uint64_t name_size = number<std::uint16_t>(m.offset + 2),
                        type_size = number<std::uint16_t>(m.offset + 4),
                        space_size = number<std::uint16_t>(m.offset + 6);
    const auto padded = [&](std::uint64_t n) { return version == 1 ? rounded_up_to_8(n) : n; };
    const std::uint64_t name_at = m.offset + (version == 3 ? 9 : 8), type_at = name_at + padded(name_size),
                        space_at = type_at + padded(type_size), data_at = space_at + padded(space_size);
    if (name_size == 0 || data_at > m.offset + m.size)
      fail(m.offset, "an attribute that does not fit its message");
    const auto* begin = bytes_.data() + name_at;
    const std::string name(begin, std::find(begin, begin + name_size, 0));
    Hdf5File::Array a;
    shape_and_type(a, Message{1, space_at, space_size}, Message{3, type_at, type_size});
    const std::uint64_t count = a.size();
    if (a.element_bytes == 0 || count > (m.offset + m.size - data_at) / a.element_bytes)
      a.unreadable = "its data does not lie with it";
    else
      a.bytes = bytes_.subspan(a.offset = data_at, count * a.element_bytes);
    file_.attributes_[path + "@" + name] = std::move(a);
  }

  std::span<const std::uint8_t> bytes_;
  Hdf5File& file_;
  std::set<std::uint64_t> open_; ///< objects on the way from the root to here
  std::size_t objects_ = 0;
};

std::uint64_t Hdf5File::Array::size() const {
  std::uint64_t n = 1;
  for (const auto d : shape)
    n *= d;
  return n;
}

bool Hdf5File::recognises(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= signature.size() && std::equal(signature.begin(), signature.end(), bytes.begin());
}

Hdf5File::Hdf5File(std::span<const std::uint8_t> bytes, std::string_view name) : name_(name) {
  Hdf5Walk(bytes, *this).superblock();
}

const Hdf5File::Array& Hdf5File::array(const std::string& path) const {
  const auto found = arrays_.find(path);
  if (found == arrays_.end()) {
    std::vector<std::string> known;
    for (const auto& [p, unused] : arrays_)
      if (known.size() < 20) known.push_back(p);
    throw Error::in_file(name_, fmt::format("no array '{}'{}", path, suggestion(path, known)));
  }
  if (!found->second.unreadable.empty())
    throw Error::in_file(name_, fmt::format("array '{}' cannot be read: {}", path, found->second.unreadable));
  return found->second;
}

namespace {

template <class T>
std::vector<T> numbers(const Hdf5File& file, const std::string& path) {
  const Hdf5File::Array& a = file.array(path);
  const bool single = a.type == Hdf5File::Type::float32;
  if (!single && a.type != Hdf5File::Type::float64)
    throw Error::in_binary(file.name(), a.offset,
                           fmt::format("array '{}': expected little-endian floats", path));
  std::vector<T> values(a.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    double x;
    if (single) {
      float y;
      std::memcpy(&y, a.bytes.data() + i * sizeof y, sizeof y);
      x = y;
    } else {
      std::memcpy(&x, a.bytes.data() + i * sizeof x, sizeof x);
    }
    values[i] = T(x);
    if (!std::isfinite(values[i]))
      throw Error::in_binary(file.name(), a.offset + i * a.element_bytes,
                             fmt::format("array '{}': expected finite numbers, found {}", path, x));
  }
  return values;
}

} // namespace

std::vector<float> Hdf5File::floats(const std::string& path) const { return numbers<float>(*this, path); }
std::vector<double> Hdf5File::doubles(const std::string& path) const { return numbers<double>(*this, path); }

std::string Hdf5File::text(const std::string& attribute, const std::string& otherwise) const {
  const auto found = attributes_.find(attribute);
  if (found == attributes_.end() || found->second.type != Type::text || !found->second.unreadable.empty())
    return otherwise;
  const auto bytes = found->second.bytes;
  return {bytes.begin(), std::find(bytes.begin(), bytes.end(), 0)};
}

} // namespace nacre
