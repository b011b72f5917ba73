// Requests for what lies in the folder.
#include "core/file.h"
#include "explorer/desk.h"

#include <algorithm>
#include <chrono>
#include <thread>

namespace nacre {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What the page can do with a file, by its ending; empty: nothing.
std::string_view kind_of(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending == ".exr" || ending == ".hdr") return "environment";
  if (ending == ".brdf") return "brdf";
  if (ending == ".json") return "json";
  if (ending == ".obj" || ending == ".ply" || ending == ".gltf" || ending == ".glb" ||
      ending == ".serialized")
    return "mesh";
  if (ending == ".png" || ending == ".jpg" || ending == ".jpeg" || ending == ".bmp") return "image";
  if (ending == ".xml") {
    // Others write measurements as .xml too; a scene says so at its beginning.
    if (!is_measured_file(path.string())) return "scene";
    std::string begin(512, '\0');
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) return "";
    begin.resize(std::fread(begin.data(), 1, begin.size(), file));
    std::fclose(file);
    return begin.find("<scene") != std::string::npos ? "scene" : "measured";
  }
  return is_measured_file(path.string()) ? "measured" : "";
}

/// Seconds since 1970.
double modified(const fs::path& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  if (error) return 0;
  return std::chrono::duration<double>(
             std::chrono::time_point_cast<std::chrono::milliseconds>(time - fs::file_time_type::clock::now() +
                                                                     std::chrono::system_clock::now())
                 .time_since_epoch())
      .count();
}

} // namespace

Answer answer_files(const Arguments& request, const Desk& desk) {
  constexpr std::size_t most = 20000;
  const fs::path folder = desk.folder.existing(request.text("folder", ""));
  if (!fs::is_directory(folder)) throw Error::in_file(request.text("folder", ""), "not a folder");
  struct Entry {
    std::string name;
    json described;
  };
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
       !error && it != end && entries.size() < most; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with('.')) continue;
    std::error_code ignored;
    const bool is_folder = it->is_directory(ignored);
    const std::string_view kind = is_folder ? "" : kind_of(it->path());
    if (!is_folder && kind.empty()) continue;
    json described{{"name", name}, {"is_folder", is_folder}, {"modified", modified(it->path())}};
    described["size"] = is_folder ? 0 : it->file_size(ignored);
    if (!is_folder) described["kind"] = kind;
    entries.push_back({(is_folder ? "0" : "1") + name, std::move(described)});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.name < b.name; });
  Answer answer;
  answer.header["entries"] = json::array();
  for (Entry& e : entries)
    answer.header["entries"].push_back(std::move(e.described));
  return answer;
}

Answer answer_read(const Arguments& request, const Desk& desk) {
  const std::string name = request.text("file");
  const fs::path path = desk.folder.existing(name);
  constexpr std::size_t most = 16u << 20;
  std::error_code error;
  if (fs::is_regular_file(path) && fs::file_size(path, error) > most)
    throw Error::in_file(name, fmt::format("larger than the {} MiB that are read as text", most >> 20));
  Answer answer;
  answer.header["text"] = read_text_file(path.string());
  return answer;
}

Answer answer_write(const Arguments& request, const Desk& desk) {
  const fs::path path =
      desk.folder.writable(request.text("file"), {".brdf", ".json", ".svg", ".csv", ".xml"});
  write_file_atomically(path.string(), std::string_view(request.long_text("text")));
  return {};
}

Answer answer_watch(const Arguments& request, const Desk& desk) {
  constexpr auto pause = std::chrono::milliseconds(250);
  struct Watched {
    std::string name;
    fs::path path;
    fs::file_time_type time;
    std::uintmax_t size;
  };
  std::vector<Watched> files;
  std::error_code error;
  // A name of nothing, such as that of a text which was not saved yet, waits for its file.
  const auto find = [&](Watched& w) {
    try {
      w.path = desk.folder.existing(w.name);
    } catch (const Error&) {
      return false;
    }
    w.time = fs::last_write_time(w.path, error), w.size = fs::file_size(w.path, error);
    return true;
  };
  const auto tell = [&](const Watched& w) {
    Answer answer;
    answer.header["changed"] = w.name;
    desk.progress(0, answer);
  };
  for (const auto& name : request.list("files", 256)) {
    if (!name.is_string()) throw Error("'files' is a list of names");
    files.push_back({name.get<std::string>(), {}, {}, 0});
    find(files.back());
  }
  while (!desk.is_cancelled()) {
    std::this_thread::sleep_for(pause);
    for (Watched& w : files) {
      if (w.path.empty()) {
        if (find(w)) tell(w);
        continue;
      }
      const auto time = fs::last_write_time(w.path, error);
      if (error) continue; // being replaced, or gone
      const auto size = fs::file_size(w.path, error);
      if (error || (time == w.time && size == w.size)) continue;
      w.time = time, w.size = size;
      tell(w);
    }
  }
  return {};
}

} // namespace nacre
