#pragma once
// Handlers without a network.

#include "core/file.h"
#include "core/scratch_folder.h"
#include "explorer/jobs.h"

#include <gtest/gtest.h>

namespace nacre {

class Workbench {
public:
  ScratchFolder folder;
  Workshop shop{Folder(folder.path()), {}, {}};
  PictureStore pictures;
  std::atomic<bool> cancelled{false};
  std::vector<std::pair<double, Answer>> progress;

  Answer ask(const std::string& type, nlohmann::json body) {
    body["type"] = type;
    Desk desk{shop.folder,
              shop.materials,
              pictures,
              shop.start,
              ++last_id,
              &cancelled,
              [&](double share, const Answer& a) {
                progress.emplace_back(share, a);
                if (on_progress) on_progress();
              }};
    return find_handler(type).answer(Arguments(body), desk);
  }
  std::string error(const std::string& type, const nlohmann::json& body) {
    try {
      ask(type, body);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }
  std::function<void()> on_progress;
  std::int64_t last_id = 0;
};

inline const NamedArray& array_of(const Answer& answer, const std::string& name) {
  for (const NamedArray& a : answer.arrays)
    if (a.name == name) return a;
  throw std::runtime_error("no array '" + name + "'");
}

inline constexpr const char* simple_brdf = R"(analytic
::begin parameters
float gain 0 2 0.5
color tint 1 0.5 0.25
bool on 1
::end parameters
::begin shader
vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {
  return on ? gain * tint / 3.14159265 : vec3(0);
}
::end shader
)";

} // namespace nacre
