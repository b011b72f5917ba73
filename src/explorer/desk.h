#pragma once
// What a handler has at hand beside its request.

#include "explorer/arguments.h"
#include "explorer/folder.h"
#include "explorer/materials.h"
#include "explorer/message.h"
#include "explorer/picture_store.h"

#include <atomic>
#include <functional>

namespace nacre {

/// What the explorer was started with.
struct Start {
  std::vector<std::string> materials; ///< as on the command line
  std::string scene;                  ///< a file to render at once, or empty
};

/// For one request: the parts that all requests share, and the request's own line to the page.
struct Desk {
  Folder& folder;
  MaterialCache& materials;
  PictureStore& pictures; ///< of the page that asks
  const Start& start;
  std::int64_t id = 0;
  const std::atomic<bool>* cancelled = nullptr;           ///< null: nobody cancels
  std::function<void(double, const Answer&)> on_progress; ///< may be empty

  bool is_cancelled() const { return cancelled && cancelled->load(std::memory_order_relaxed); }
  void progress(double share, const Answer& answer) const {
    if (on_progress) on_progress(share, answer);
  }
};

/// How a request is run.
enum class Pace {
  brief,  ///< answered at once; evaluates nothing, and never waits for what does
  quick,  ///< answered at once, each of them
  latest, ///< of those of one slot that wait, the newest alone is answered
  slow    ///< on a thread of its own, with progress, until done or cancelled
};

struct Handler {
  std::string_view type;
  Pace pace;
  Answer (*answer)(const Arguments& request, const Desk& desk);
};

/// The closed list of requests.
const std::vector<Handler>& handlers();
/// @throws Error that suggests the nearest type
const Handler& find_handler(std::string_view type);

/// What `export` writes: name, summary and ending of each.
nlohmann::json formats_json();

/// A material of the command line as a page names it. @throws Error for a file outside the folder
nlohmann::json start_material(const std::string& text, const Folder& folder);

// One file a group.
Answer answer_hello(const Arguments& request, const Desk& desk);
Answer answer_material(const Arguments& request, const Desk& desk);
Answer answer_compile(const Arguments& request, const Desk& desk);
Answer answer_export(const Arguments& request, const Desk& desk);
Answer answer_curves(const Arguments& request, const Desk& desk);
Answer answer_lobe3d(const Arguments& request, const Desk& desk);
Answer answer_slice(const Arguments& request, const Desk& desk);
Answer answer_sphere(const Arguments& request, const Desk& desk);
Answer answer_furnace(const Arguments& request, const Desk& desk);
Answer answer_files(const Arguments& request, const Desk& desk);
Answer answer_read(const Arguments& request, const Desk& desk);
Answer answer_write(const Arguments& request, const Desk& desk);
Answer answer_watch(const Arguments& request, const Desk& desk);
Answer answer_object(const Arguments& request, const Desk& desk);
Answer answer_render(const Arguments& request, const Desk& desk);
Answer answer_inspect(const Arguments& request, const Desk& desk);
Answer answer_display(const Arguments& request, const Desk& desk);
Answer answer_save(const Arguments& request, const Desk& desk);
Answer answer_fit(const Arguments& request, const Desk& desk);
Answer answer_validate(const Arguments& request, const Desk& desk);
Answer answer_physics(const Arguments& request, const Desk& desk);

} // namespace nacre
