#pragma once
// Writing of HDF5 files to memory, by HDF5's own library, which is known here alone.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace nacre {

/// One file. Many may be written at once, by threads of their own; the library serves one call at a time.
/// @throws Error if the library fails, from all functions
class Hdf5Writer {
public:
  Hdf5Writer();
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// Groups on the way must be there.
  void group(const std::string& path);
  void array(const std::string& path, std::span<const std::uint64_t> shape, const std::uint8_t* values);
  void array(const std::string& path, std::span<const std::uint64_t> shape, const float* values);
  void array(const std::string& path, std::span<const std::uint64_t> shape, const double* values);
  /// @param path  of a group or array, "/" for the root
  void attribute(const std::string& path, const std::string& name, const std::string& text);
  void attribute(const std::string& path, const std::string& name, std::int32_t number);
  /// The whole file; nothing can be added after. The same calls give the same bytes.
  std::vector<std::uint8_t> finish();

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace nacre
