#include "measured/formats/hdf5_writer.h"

#include "core/error.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <mutex>
#include <utility>

namespace nacre {
namespace {

/// Debian's library is built without a promise of thread safety.
std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// The library for one thread, and without its habit of printing errors.
class Library {
public:
  Library() {
    H5Eget_auto2(H5E_DEFAULT, &report_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Library() { H5Eset_auto2(H5E_DEFAULT, report_, data_); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

private:
  std::lock_guard<std::mutex> lock_{library_mutex()};
  H5E_auto2_t report_ = nullptr;
  void* data_ = nullptr;
};

/// An identifier of the library, closed at the end of its scope.
class Handle {
public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {
    if (id < 0) throw Error("HDF5's library failed to write to memory");
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

void check(herr_t result) {
  if (result < 0) throw Error("HDF5's library failed to write to memory");
}

} // namespace

struct Hdf5Writer::State {
  Handle file;

  void array(const std::string& path, std::span<const std::uint64_t> shape, hid_t stored, hid_t given,
             const void* values) {
    const std::vector<hsize_t> sizes(shape.begin(), shape.end());
    const Handle space(H5Screate_simple(int(sizes.size()), sizes.data(), nullptr), H5Sclose);
    const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    check(H5Pset_obj_track_times(how, false)); // the same data give the same file
    const Handle set(H5Dcreate2(file, path.c_str(), stored, space, H5P_DEFAULT, how, H5P_DEFAULT), H5Dclose);
    bool empty = false;
    for (const hsize_t n : sizes)
      empty |= n == 0;
    if (!empty) check(H5Dwrite(set, given, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  }
  void attribute(const std::string& path, const std::string& name, hid_t type, const void* value) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle object(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose);
    const Handle a(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    check(H5Awrite(a, type, value));
  }
};

Hdf5Writer::Hdf5Writer() : state_(std::make_unique<State>()) {
  const Library library;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t growth = std::size_t(1) << 20;
  check(H5Pset_fapl_core(access, growth, false)); // in memory, never on disk
  const Handle how(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  check(H5Pset_obj_track_times(how, false));
  // The library takes files in memory with one name for one file.
  static int count = 0;
  state_->file =
      Handle(H5Fcreate(fmt::format("memory {}", ++count).c_str(), H5F_ACC_TRUNC, how, access), H5Fclose);
}

Hdf5Writer::~Hdf5Writer() {
  const Library library;
  state_.reset();
}

void Hdf5Writer::group(const std::string& path) {
  const Library library;
  const Handle how(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  check(H5Pset_obj_track_times(how, false));
  const Handle made(H5Gcreate2(state_->file, path.c_str(), H5P_DEFAULT, how, H5P_DEFAULT), H5Gclose);
}

void Hdf5Writer::array(const std::string& path, std::span<const std::uint64_t> shape,
                       const std::uint8_t* values) {
  const Library library;
  state_->array(path, shape, H5T_STD_U8LE, H5T_NATIVE_UINT8, values);
}
void Hdf5Writer::array(const std::string& path, std::span<const std::uint64_t> shape, const float* values) {
  const Library library;
  state_->array(path, shape, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, values);
}
void Hdf5Writer::array(const std::string& path, std::span<const std::uint64_t> shape, const double* values) {
  const Library library;
  state_->array(path, shape, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values);
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, const std::string& text) {
  const Library library;
  // An attribute lies in a header of 64 KB; a name this long is no name.
  const std::string kept = text.substr(0, 4096);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  check(H5Tset_size(type, kept.size() + 1));
  check(H5Tset_cset(type, H5T_CSET_UTF8));
  state_->attribute(path, name, type, kept.c_str());
}
void Hdf5Writer::attribute(const std::string& path, const std::string& name, std::int32_t number) {
  const Library library;
  state_->attribute(path, name, H5T_STD_I32LE, &number);
}

std::vector<std::uint8_t> Hdf5Writer::finish() {
  const Library library;
  check(H5Fflush(state_->file, H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(state_->file, nullptr, 0);
  if (size <= 0) throw Error("HDF5's library failed to write to memory");
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  if (H5Fget_file_image(state_->file, bytes.data(), bytes.size()) != size)
    throw Error("HDF5's library failed to write to memory");
  return bytes;
}

} // namespace nacre
