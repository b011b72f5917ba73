#pragma once
// Files are read whole, and written whole or not at all.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// The bytes of a regular file. A directory, a missing or an unreadable file is an Error that says which.
std::vector<std::uint8_t> read_file(const std::string& path);
std::string read_text_file(const std::string& path);

/// While it lives, the whole process reads only files below these folders, whoever asks and however the file
/// is named, links followed. For programs that take names of files from elsewhere. One at a time.
class ReadingFence {
public:
  explicit ReadingFence(const std::vector<std::filesystem::path>& folders);
  ~ReadingFence();
  ReadingFence(const ReadingFence&) = delete;
  ReadingFence& operator=(const ReadingFence&) = delete;
};
/// True where `path`, both canonical, is `folder` or lies below it.
bool lies_below(const std::filesystem::path& path, const std::filesystem::path& folder);

/// Writes beside `path` and renames: after a failure (a full disk, a missing folder, a kill) `path` is as it
/// was before and no partial file is left. A symbolic link is followed; a device or pipe (/dev/null,
/// /dev/stdout) is written to in place. @throws Error naming `path` and the reason
void write_file_atomically(const std::string& path, std::span<const std::uint8_t> bytes);
void write_file_atomically(const std::string& path, std::string_view text);

/// `name` itself if absolute, else the first of `folders`/name that exists; an empty folder is the current
/// one. @throws Error listing where it was looked for, with the nearest name found there.
std::string find_file(const std::string& name, std::span<const std::string> folders);

} // namespace nacre
