#pragma once
// A folder of results that is complete or as it was before.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// Until `keep` is called, leaving the scope removes every file that was not there before, and the folders
/// that were made.
class OutputFolder {
public:
  /// Makes the folder, and those above it, where missing. @throws Error if it is no folder, cannot be made or
  /// cannot be written to
  explicit OutputFolder(const std::string& path);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Lets `write` write the file of that name, whole or not at all; the path is what it is given.
  /// @return the path
  std::string add(const std::string& name, const std::function<void(const std::string&)>& write);
  void keep() { kept_ = true; }

private:
  void undo();
  std::string path_;
  std::vector<std::string> new_files_, new_folders_; ///< in the order they were made
  bool kept_ = false;
};

} // namespace nacre
