#pragma once
// The part of the disk that the explorer may touch: what lies below the folder it was started in, and what
// was dropped onto the page.

#include <filesystem>
#include <string>
#include <string_view>

namespace nacre {

class Folder {
public:
  /// @param root  an existing folder. @throws Error
  explicit Folder(const std::filesystem::path& root);
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  /// Removes what was dropped.
  ~Folder();

  const std::filesystem::path& root() const { return root_; }

  /// The path of an existing file or folder below the root, symbolic links followed; "upload:NAME" is what
  /// was dropped under this name, "" the root. @throws Error for what leads outside, or is not there
  std::filesystem::path existing(std::string_view name) const;
  /// The same for a file that another one below the root, or dropped, may name by its whole path.
  std::string found(const std::string& name) const;
  /// Where a new file goes, or one that is there and is replaced: its folder exists below the root.
  /// @param endings  the only ones allowed, ".brdf"
  std::filesystem::path writable(std::string_view name,
                                 std::initializer_list<std::string_view> endings) const;
  /// `path` as the page names it: below the root, with '/'.
  std::string name_of(const std::filesystem::path& path) const;

  /// Where what is dropped is put: a folder of its own among the system's temporary ones.
  const std::filesystem::path& uploads() const { return uploads_; }
  /// The place of the file NAME there. @throws Error for a name that is no plain file name
  std::filesystem::path upload_path(std::string_view name) const;

private:
  std::filesystem::path root_, uploads_;
};

} // namespace nacre
