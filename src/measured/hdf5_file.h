#pragma once
// Reading of HDF5 files held in memory, of the part of the format that HDF5's library and h5py write unless
// told otherwise: superblock 0 or 1, groups as symbol tables, object headers of version 1, arrays stored in
// one piece. Source: The HDF Group, HDF5 File Format Specification 3.0, sections II to IV.
//
// The library itself crashes or loops on some damaged files (1.10.8: 1 and 4 of 8,000 with changed bytes),
// so files from outside are read by this. Every offset is checked against the bytes there are.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// The groups, arrays and attributes of one file. Views into `bytes`, which outlive it.
class Hdf5File {
public:
  enum class Type { float32, float64, int8, uint8, int32, uint32, int64, uint64, text, other };
  struct Array {
    std::vector<std::uint64_t> shape; ///< empty: one number
    Type type = Type::other;
    std::size_t element_bytes = 0;
    std::uint64_t offset = 0;            ///< of the data in the file
    std::span<const std::uint8_t> bytes; ///< size of the shape times element_bytes, if readable
    std::string unreadable;              ///< why, if this reader cannot read it; else empty
    std::uint64_t size() const;          ///< elements
  };

  /// @throws Error with the byte offset unless the bytes are a whole file of that part of the format
  Hdf5File(std::span<const std::uint8_t> bytes, std::string_view name);

  /// True if the bytes begin as an HDF5 file.
  static bool recognises(std::span<const std::uint8_t> bytes);

  /// Paths without a leading slash, "dense_1/dense_1/kernel:0".
  const std::map<std::string, Array>& arrays() const { return arrays_; }
  /// Attributes of the root group and of arrays and groups, as "PATH@NAME", the root's "@NAME".
  const std::map<std::string, Array>& attributes() const { return attributes_; }
  const std::string& name() const { return name_; }

  /// @throws Error if there is none of this path, with the nearest, or it cannot be read
  const Array& array(const std::string& path) const;
  /// Numbers of a float array, all finite. @throws Error with the byte offset
  std::vector<float> floats(const std::string& path) const;
  std::vector<double> doubles(const std::string& path) const;
  /// A text attribute, or `otherwise` where there is none. Zero bytes at its end are dropped.
  std::string text(const std::string& attribute, const std::string& otherwise = {}) const;

private:
  friend class Hdf5Walk;
  std::string name_;
  std::map<std::string, Array> arrays_, attributes_;
};

} // namespace nacre
