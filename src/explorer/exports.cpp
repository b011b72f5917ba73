// Requests for a material in the words of other programs.
#include "core/file.h"
#include "explorer/desk.h"
#include "fit/export_material.h"

namespace nacre {
namespace {

/// What the texts that name a .brdf file do not say: that it is not yet as the page has it.
std::string unsaved_remark(const Arguments& material, const MaterialSpec& resolved, const Desk& desk) {
  if (!material.has("brdf")) return "";
  const std::string &name = resolved.lobes[0].user->info().name,
                    source = material.object("brdf").long_text("source");
  try {
    if (read_text_file(desk.folder.existing(name).string()) == source) return "";
  } catch (const Error&) {
    // There is no such file yet.
  }
  return fmt::format("names {}, which is not saved as it is in the editor", name);
}

constexpr const char* text_format = "text"; ///< a MATERIAL of the command line, the one that is no file

} // namespace

nlohmann::json formats_json() {
  nlohmann::json list{
      {{"name", text_format}, {"summary", "a MATERIAL of the command line"}, {"ending", ".txt"}}};
  for (const ExportFormat& f : export_formats())
    list.push_back({{"name", f.ending.substr(1)}, {"summary", f.name}, {"ending", f.ending}});
  return list;
}

Answer answer_export(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  const std::string format = request.text("format");
  Answer answer;
  if (format == text_format) {
    to_json(*material); // an error where it is not made of listed models
    answer.header["text"] = to_text(*material) + "\n";
    const std::string unsaved = unsaved_remark(request.object("material"), *material, desk);
    answer.header["remark"] = unsaved.empty() ? "exact" : unsaved;
    return answer;
  }
  std::vector<std::string> known{text_format};
  for (const ExportFormat& f : export_formats())
    known.push_back(f.ending.substr(1));
  if (std::find(known.begin(), known.end(), format) == known.end())
    throw Error(fmt::format("unknown format '{}'{}", format, suggestion(format, known)));
  const Translation t = translate(*material, "." + format);
  answer.header["text"] = t.text;
  std::string remark =
      t.is_exact() ? "exact"
                   : fmt::format("{}; log error {:.3g}, largest relative difference {:.3g}",
                                 t.fitted ? "fitted" : "the nearest to it", t.error.log, t.error.relative);
  for (const std::string& r : t.remarks)
    remark += "; " + r;
  answer.header["remark"] = remark;
  answer.header["exact"] = t.is_exact();
  return answer;
}

} // namespace nacre
