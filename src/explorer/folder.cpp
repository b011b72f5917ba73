#include "explorer/folder.h"

#include "core/error.h"
#include "core/file.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>

namespace nacre {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view upload_prefix = "upload:";

/// A name is a path below the root, said without leaving it.
void check_name(std::string_view name) {
  if (name.find('\0') != std::string_view::npos) throw Error("a file's name holds no zero byte");
  if (name.size() > 4096) throw Error("a file's name is at most 4096 bytes long");
  const fs::path path{std::string(name)};
  if (path.is_absolute())
    throw Error::in_file(name, "the explorer opens files below the folder it was started in: give a name "
                               "relative to it");
  for (const fs::path& part : path)
    if (part == "..")
      throw Error::in_file(name, "'..' leads out: the explorer opens only files below the folder it was "
                                 "started in");
}

void check_plain(std::string_view name) {
  const auto plain = [](char c) { return static_cast<unsigned char>(c) >= 32 && c != 127; };
  if (name.empty() || name.size() > 200 || name[0] == '.' ||
      name.find_first_of("/\\:") != std::string_view::npos || !std::all_of(name.begin(), name.end(), plain))
    throw Error(fmt::format("'{}' is no plain file name", name.substr(0, 200)));
}

} // namespace

Folder::Folder(const fs::path& root) {
  std::error_code error;
  root_ = fs::canonical(root, error);
  if (error || !fs::is_directory(root_)) throw Error::in_file(root.string(), "not a folder");
  std::string made = (fs::temp_directory_path() / "nacre-explore-XXXXXX").string();
  if (!::mkdtemp(made.data()))
    throw Error::in_file(made, "cannot be made, for what is dropped onto the page");
  uploads_ = fs::canonical(made);
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(uploads_, ignored);
}

fs::path Folder::existing(std::string_view name) const {
  if (name.starts_with(upload_prefix)) {
    const std::string_view plain = name.substr(upload_prefix.size());
    check_plain(plain);
    const fs::path path = uploads_ / plain;
    std::error_code ignored;
    if (!fs::is_regular_file(fs::symlink_status(path, ignored)))
      throw Error::in_file(name, "was not dropped onto this explorer");
    return path;
  }
  check_name(name);
  std::error_code error;
  const fs::path path = fs::canonical(root_ / std::string(name), error);
  if (error) throw Error::in_file(name, "no such file");
  if (!lies_below(path, root_))
    throw Error::in_file(name, "a link leads out of the folder that the explorer was started in");
  return path;
}

std::string Folder::found(const std::string& name) const {
  std::error_code error;
  const fs::path path(name);
  if (!path.is_absolute()) return existing(name).string();
  const fs::path canonical = fs::canonical(path, error);
  if (error || !(lies_below(canonical, root_) || lies_below(canonical, uploads_))) check_name(name);
  return canonical.string();
}

fs::path Folder::writable(std::string_view name, std::initializer_list<std::string_view> endings) const {
  check_name(name);
  const fs::path asked{std::string(name)};
  const std::string ending = asked.extension().string();
  if (std::find(endings.begin(), endings.end(), ending) == endings.end())
    throw Error::in_file(name,
                         fmt::format("the explorer writes files that end in {}", fmt::join(endings, ", ")));
  std::error_code error;
  const fs::path folder = fs::canonical(root_ / asked.parent_path(), error);
  if (error || !fs::is_directory(folder)) throw Error::in_file(name, "its folder does not exist");
  const fs::path path = folder / asked.filename();
  if (!lies_below(folder, root_))
    throw Error::in_file(name, "a link leads out of the folder that the explorer was started in");
  // What is there is replaced if it is a file; a link could lead anywhere, even one to nothing.
  const auto there = fs::symlink_status(path, error).type();
  if (there == fs::file_type::none) throw Error::in_file(name, "cannot be written: " + error.message());
  if (there != fs::file_type::not_found && there != fs::file_type::regular)
    throw Error::in_file(name, "is there and is no plain file: it is left as it is");
  return path;
}

std::string Folder::name_of(const fs::path& path) const {
  if (path.parent_path() == uploads_) return std::string(upload_prefix) + path.filename().string();
  return path.lexically_relative(root_).generic_string();
}

fs::path Folder::upload_path(std::string_view name) const {
  check_plain(name);
  return uploads_ / name;
}

} // namespace nacre
