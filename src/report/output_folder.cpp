#include "report/output_folder.h"

#include "core/error.h"

#include <algorithm>
#include <filesystem>
#include <unistd.h>

namespace nacre {
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  if (path.empty()) throw Error("the name of the output folder is empty");
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error))
    throw Error::in_file(path, "is a file, expected a folder to write to");
  // From the outermost that is missing inwards.
  std::vector<fs::path> missing;
  const fs::path whole = fs::absolute(path).lexically_normal();
  for (fs::path p = whole; !p.empty() && !fs::exists(p, error); p = p.parent_path())
    if (p.has_filename()) missing.push_back(p);
  for (auto p = missing.rbegin(); p != missing.rend(); ++p) {
    if (fs::create_directory(*p, error)) new_folders_.push_back(p->string());
    if (error) {
      undo();
      throw Error::in_file(path, "the folder cannot be made: " + error.message());
    }
  }
  if (::access(path.c_str(), W_OK | X_OK) != 0) {
    undo();
    throw Error::in_file(path, "the folder is not writable");
  }
}

OutputFolder::~OutputFolder() {
  if (!kept_) undo();
}

void OutputFolder::undo() {
  std::error_code ignored;
  for (const std::string& file : new_files_)
    fs::remove(file, ignored);
  for (auto folder = new_folders_.rbegin(); folder != new_folders_.rend(); ++folder)
    fs::remove(*folder, ignored);
}

std::string OutputFolder::add(const std::string& name, const std::function<void(const std::string&)>& write) {
  const std::string file = (fs::path(path_) / name).string();
  std::error_code ignored;
  const bool existed = fs::exists(fs::symlink_status(file, ignored));
  write(file);
  if (!existed) new_files_.push_back(file);
  return file;
}

} // namespace nacre
