#include "core/file.h"

#include "core/error.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <mutex>
#include <sys/stat.h>
#include <unistd.h>

namespace nacre {
namespace {

std::string reason(int error_number) { return std::strerror(error_number); }

/// Closes on leaving the scope, keeping errno as it was.
struct Descriptor {
  int fd;
  explicit Descriptor(int opened) : fd(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    const int kept = errno;
    if (fd >= 0) ::close(fd);
    errno = kept;
  }
};

std::mutex fence_mutex;
std::vector<std::filesystem::path> fence; ///< empty: none

/// Asks the open file where it lies, so that nothing can change between the question and the reading.
void check_fence(int fd, const std::string& path) {
  const std::lock_guard lock(fence_mutex);
  if (fence.empty()) return;
  std::error_code error;
  std::filesystem::path real = std::filesystem::read_symlink(fmt::format("/proc/self/fd/{}", fd), error);
  if (error) real = std::filesystem::canonical(path, error);
  for (const auto& folder : fence)
    if (!error && lies_below(real, folder)) return;
  throw Error::in_file(path,
                       fmt::format("lies outside '{}': nothing else is opened", fence.front().string()));
}

template <class Buffer>
Buffer read_into(const std::string& path) {
  if (path.empty()) throw Error("the name of the file to read is empty");
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (file.fd < 0) {
    if (errno == ENOENT) throw Error::in_file(path, "no such file");
    throw Error::in_file(path, "cannot be opened: " + reason(errno));
  }
  check_fence(file.fd, path);
  if (::fstat(file.fd, &status) != 0) throw Error::in_file(path, "cannot be examined: " + reason(errno));
  if (S_ISDIR(status.st_mode)) throw Error::in_file(path, "is a directory, expected a file");
  if (!S_ISREG(status.st_mode)) throw Error::in_file(path, "is not a regular file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  const auto memory = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                      static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  if (size > memory)
    throw Error::in_file(path, fmt::format("has {} bytes, more than this machine's memory", size));

  Buffer buffer;
  try {
    buffer.resize(size);
    // The size is only a promise (files of the kernel say 0, others grow): read until the end says so.
    for (std::size_t done = 0;;) {
      if (done == buffer.size()) {
        char more;
        const ssize_t n = ::read(file.fd, &more, 1);
        if (n == 0) return buffer;
        if (n < 0 && errno != EINTR) throw Error::in_file(path, "cannot be read: " + reason(errno));
        if (n < 0) continue;
        buffer.resize(done + 65536);
        buffer[done++] = static_cast<typename Buffer::value_type>(more);
      }
      const ssize_t n = ::read(file.fd, buffer.data() + done, buffer.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) throw Error::in_file(path, "cannot be read: " + reason(errno));
      done += static_cast<std::size_t>(n);
      if (n == 0) {
        buffer.resize(done);
        return buffer;
      }
    }
  } catch (const std::bad_alloc&) {
    throw Error::in_file(path, fmt::format("has {} bytes, too many for the memory left", size));
  }
}

[[noreturn]] void fail_to_write(const std::string& path, int error_number) {
  throw Error::in_file(path, "cannot be written: " + reason(error_number));
}

/// False with errno set if not all bytes could be written.
bool write_all(int fd, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

/// The new contents of a file on their way to its name. Where the file system allows, they have no name at
/// all until they are whole, so that not even a kill leaves a trace.
class NewFile {
public:
  NewFile(const std::string& target, mode_t mode) : target_(target) {
    static std::atomic<unsigned> count{0};
    beside_ = fmt::format("{}.{}.{}.tmp", target, ::getpid(), count++);
    if (::access("/proc/self/fd", X_OK) == 0)
      fd_ = ::open(folder_of(target).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
    if (fd_ >= 0) return;
    fd_ = ::open(beside_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, mode);
    named_ = fd_ >= 0;
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile() {
    if (fd_ >= 0) ::close(fd_);
    if (named_) ::unlink(beside_.c_str());
  }
  int fd() const { return fd_; }
  /// Gives the contents the target's name; false with errno set if that fails.
  bool publish() {
    if (!named_) {
      const std::string by_descriptor = fmt::format("/proc/self/fd/{}", fd_);
      if (::linkat(AT_FDCWD, by_descriptor.c_str(), AT_FDCWD, beside_.c_str(), AT_SYMLINK_FOLLOW) != 0)
        return false;
      named_ = true;
    }
    if (::rename(beside_.c_str(), target_.c_str()) != 0) return false;
    named_ = false;
    return true;
  }

private:
  std::string target_, beside_;
  int fd_ = -1;
  bool named_ = false;
};

} // namespace

ReadingFence::ReadingFence(const std::vector<std::filesystem::path>& folders) {
  std::vector<std::filesystem::path> canonical;
  for (const auto& folder : folders)
    canonical.push_back(std::filesystem::canonical(folder));
  const std::lock_guard lock(fence_mutex);
  fence = std::move(canonical);
}
ReadingFence::~ReadingFence() {
  const std::lock_guard lock(fence_mutex);
  fence.clear();
}

bool lies_below(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::vector<std::uint8_t> read_file(const std::string& path) {
  return read_into<std::vector<std::uint8_t>>(path);
}
std::string read_text_file(const std::string& path) { return read_into<std::string>(path); }

void write_file_atomically(const std::string& path, std::span<const std::uint8_t> bytes) {
  if (path.empty()) throw Error("the name of the file to write is empty");
  std::string target = path;
  mode_t mode = 0666; // less the user's umask
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw Error::in_file(path, "cannot be written: it is a directory");
    if (!S_ISREG(status.st_mode)) {
      const Descriptor device(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
      if (device.fd < 0 || !write_all(device.fd, bytes)) fail_to_write(path, errno);
      return;
    }
    // A rename would replace a write-protected file without a word, and a link instead of what it names.
    if (::access(path.c_str(), W_OK) != 0) fail_to_write(path, errno);
    target = std::filesystem::canonical(path).string();
    mode = status.st_mode & 07777;
  } else if (errno == ENOENT && path.back() == '/') {
    throw Error::in_file(path, "cannot be written: it is the name of a folder");
  }

  NewFile file(target, mode);
  if (file.fd() < 0 && (errno == ENOENT || errno == ENOTDIR))
    throw Error::in_file(path, fmt::format("cannot be written: there is no folder '{}'", folder_of(target)));
  // fsync brings out the errors that a file system would otherwise keep until after the rename.
  if (file.fd() < 0 || !write_all(file.fd(), bytes) || ::fsync(file.fd()) != 0 || !file.publish())
    fail_to_write(path, errno);
}

void write_file_atomically(const std::string& path, std::string_view text) {
  write_file_atomically(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string find_file(const std::string& name, std::span<const std::string> folders) {
  namespace fs = std::filesystem;
  if (name.empty()) throw Error("the name of the file to look for is empty");
  if (name.front() == '/') return name;
  std::vector<std::string> neighbours;
  std::string looked, folder_found;
  for (const std::string& folder : folders) {
    const fs::path candidate = fs::path(folder) / name;
    std::error_code ignored;
    const bool is_folder = fs::is_directory(candidate, ignored);
    if (is_folder && folder_found.empty()) folder_found = candidate.string();
    if (!is_folder && fs::exists(candidate, ignored)) return candidate.string();
    looked += fmt::format("{}'{}'", looked.empty() ? "" : ", ", folder.empty() ? "." : folder);
    const fs::path parent = candidate.has_parent_path() ? candidate.parent_path() : fs::path(".");
    for (fs::directory_iterator entry(parent, ignored), end; !ignored && entry != end;
         entry.increment(ignored))
      neighbours.push_back((fs::path(name).parent_path() / entry->path().filename()).string());
  }
  if (!folder_found.empty()) throw Error::in_file(folder_found, "is a directory, expected a file");
  const std::string nearest = nearest_name(name, neighbours);
  throw Error::in_file(name, fmt::format("no such file in {}{}", looked.empty() ? "any folder" : looked,
                                         nearest.empty() ? "" : " (did you mean '" + nearest + "'?)"));
}

} // namespace nacre
