#pragma once
// The container `tensor_file`: named arrays of numbers in one binary file. The measurements of RGL/EPFL
// (.bsdf) and KAIST (.pbsdf) come in it. Layout, all little-endian: 12 bytes "tensor_file\0"; version 1, 0 (a
// byte each); uint32 number of fields; a field: uint16 length of its name, the name, uint16 number of
// dimensions, uint8 type, uint64 offset of its data from the start of the file, a uint64 size a dimension;
// the data, row-major, last index fastest. Source: the readers and the writer of Dupuy and Jakob 2018
// (brdf-loader).

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// The number in the file that stands for a type.
enum class TensorType : std::uint8_t {
  uint8 = 1,
  int8,
  uint16,
  int16,
  uint32,
  int32,
  uint64,
  int64,
  float16,
  float32,
  float64
};
std::string_view to_text(TensorType type);
std::size_t size_of(TensorType type);

/// An array, in a file that was read or to be written.
struct Tensor {
  std::string name;
  TensorType type = TensorType::uint8;
  std::vector<std::uint64_t> shape;
  std::span<const std::uint8_t> bytes; ///< product of the shape times size_of(type)
  std::uint64_t header_offset = 0;     ///< where the file declares it
  std::uint64_t offset = 0;            ///< where its data begins
};
/// "4 x 32 x 32"
std::string to_text(std::span<const std::uint64_t> shape);

/// A file's fields, each within the file and no two overlapping; views into the bytes given, which outlive
/// it.
class TensorFile {
public:
  /// @throws Error with the byte offset for anything else
  static TensorFile parse(std::span<const std::uint8_t> bytes, std::string_view name);
  /// True where the bytes begin as such a file does.
  static bool recognises(std::span<const std::uint8_t> bytes);

  const std::vector<Tensor>& fields() const { return fields_; }
  const Tensor* find(std::string_view name) const;
  /// A field of this type and number of dimensions.
  /// @throws Error naming the nearest field there is, or the type and shape found
  const Tensor& field(std::string_view name, TensorType type, std::size_t dimensions) const;
  /// The numbers of a field of type float32 with this many dimensions. NaN is let through only on request.
  /// @throws Error as `field`, or with the place of the first number that is NaN or infinite
  std::vector<float> floats(std::string_view name, std::size_t dimensions, bool allow_nan = false) const;
  /// An error at the place where the file declares this field.
  [[noreturn]] void fail(const Tensor& field, std::string_view message) const;

private:
  std::string name_;
  std::uint64_t end_of_header_ = 0;
  std::vector<Tensor> fields_;
};

/// A float32 or uint8 array over memory of the caller's.
Tensor tensor(std::string name, std::vector<std::uint64_t> shape, std::span<const float> values);
Tensor tensor(std::string name, std::string_view text);
Tensor tensor(std::string name, std::vector<std::uint64_t> shape, std::span<const std::uint8_t> values);

/// The bytes of such a file, each array's data at a multiple of 8.
/// @throws Error if two share a name, or bytes and shape of one disagree
std::vector<std::uint8_t> encode_tensor_file(std::span<const Tensor> fields);

} // namespace nacre
