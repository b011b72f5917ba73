#include "core/file.h"
#include "core/version.h"
#include "display/tonemap.h"
#include "explorer/desk.h"
#include "fit/fit.h"

#include <algorithm>

namespace nacre {

using nlohmann::json;

const std::vector<Handler>& handlers() {
  static const std::vector<Handler> list{
      {"hello", Pace::brief, answer_hello},      {"material", Pace::quick, answer_material},
      {"compile", Pace::quick, answer_compile},  {"export", Pace::slow, answer_export},
      {"curves", Pace::latest, answer_curves},   {"lobe3d", Pace::latest, answer_lobe3d},
      {"slice", Pace::latest, answer_slice},     {"sphere", Pace::latest, answer_sphere},
      {"furnace", Pace::latest, answer_furnace}, {"files", Pace::brief, answer_files},
      {"read", Pace::brief, answer_read},        {"write", Pace::brief, answer_write},
      {"watch", Pace::slow, answer_watch},       {"object", Pace::slow, answer_object},
      {"render", Pace::slow, answer_render},     {"inspect", Pace::quick, answer_inspect},
      {"display", Pace::latest, answer_display}, {"save", Pace::quick, answer_save},
      {"fit", Pace::slow, answer_fit},           {"validate", Pace::slow, answer_validate},
      {"physics", Pace::latest, answer_physics},
  };
  return list;
}

const Handler& find_handler(std::string_view type) {
  std::vector<std::string> known;
  for (const Handler& h : handlers()) {
    if (h.type == type) return h;
    known.emplace_back(h.type);
  }
  throw Error(fmt::format("unknown type of message '{}'{}", type.substr(0, 60),
                          suggestion(type.substr(0, 60), known)));
}

json start_material(const std::string& text, const Folder& folder) {
  const std::filesystem::path path(text);
  const auto ending = path.extension();
  const bool is_file = ending == ".json" || ending == ".brdf" || is_measured_file(text);
  if (!is_file || text.find('=') != std::string::npos) return {{"text", text}};
  std::error_code error;
  const auto canonical = std::filesystem::canonical(path, error);
  if (error) throw Error::in_file(text, "no such file");
  if (!lies_below(canonical, folder.root()))
    throw Error::in_file(text, "lies outside the current folder, below which alone the explorer opens files");
  return {{"file", folder.name_of(canonical)}};
}

namespace {

std::string_view summary_of(Metric metric) {
  switch (metric) {
  case Metric::cosine:
    return "of f cos theta_i; Ngan et al. 2005";
  case Metric::log:
    return "of log(1 + f cos theta_i); Loew et al. 2012";
  case Metric::cube_root:
    return "of the cube root of f cos theta_i; Fores et al. 2012";
  case Metric::relative:
    return "of f cos theta_i, relative to the measured value";
  }
  return "";
}

} // namespace

Answer answer_hello(const Arguments&, const Desk& desk) {
  Answer answer;
  json& h = answer.header;
  h["version"] = version();
  h["root"] = desk.folder.root().filename().string();
  h["models"] = json::array();
  for (const ModelInfo& model : model_infos())
    h["models"].push_back(model_json(model));
  h["start"] = json::array();
  for (const std::string& material : desk.start.materials)
    h["start"].push_back(start_material(material, desk.folder));
  if (!desk.start.scene.empty())
    h["scene"] = desk.folder.name_of(std::filesystem::weakly_canonical(desk.start.scene));
  h["metrics"] = json::array();
  for (const Metric metric : all_metrics)
    h["metrics"].push_back({{"name", metric_name(metric)}, {"summary", summary_of(metric)}});
  // The first is what a fit takes if none is named.
  std::stable_partition(h["metrics"].begin(), h["metrics"].end(),
                        [](const json& m) { return m["name"] == metric_name(FitOptions().metric); });
  h["integrators"] = {{{"name", "path"}, {"summary", "all light"}},
                      {{"name", "direct"}, {"summary", "light after one reflection"}}};
  h["operators"] = json::array();
  for (const ToneOperator& op : tone_operators()) {
    json parameters = json::array();
    for (const ToneParameter& p : op.parameters)
      parameters.push_back({{"name", p.name},
                            {"unit", "1"},
                            {"meaning", p.meaning},
                            {"lo", p.min},
                            {"hi", p.max},
                            {"initial", p.value},
                            {"is_color", false},
                            {"is_switch", false}});
    h["operators"].push_back({{"name", op.name},
                              {"summary", op.meaning},
                              {"source", op.source},
                              {"parameters", std::move(parameters)}});
  }
  h["formats"] = formats_json();
  return answer;
}

} // namespace nacre
