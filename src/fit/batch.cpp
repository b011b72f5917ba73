#include "fit/batch.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/version.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

namespace nacre {

namespace fs = std::filesystem;

namespace {

/// The options with the contents of the .brdf files among the models: an edited file is another model.
std::string with_shaders(const std::string& options, const std::string& model) {
  nlohmann::json json = nlohmann::json::parse(options);
  try {
    for (const LobeSpec& lobe : parse_material(model).lobes)
      if (lobe.user) json["shaders"][lobe.user->info().name] = content_hash(lobe.user->info().name);
  } catch (const Error&) {
    // Its fit says what is wrong with it.
  }
  return json.dump();
}

} // namespace

std::vector<std::string> measured_files(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
      std::vector<std::string> found;
      for (const auto& entry : fs::directory_iterator(path, error))
        if (entry.is_regular_file() && is_measured_file(entry.path().string()))
          found.push_back(entry.path().string());
      if (error) throw Error::in_file(path, "the folder cannot be read: " + error.message());
      std::sort(found.begin(), found.end());
      files.insert(files.end(), found.begin(), found.end());
    } else if (fs::exists(path, error)) {
      files.push_back(path);
    } else {
      throw Error::in_file(path, "no such file or folder");
    }
  }
  if (files.empty())
    throw Error("no measurements in " + (paths.empty() ? std::string("nothing") : paths.front()));
  return files;
}

BatchResult fit_all(const std::vector<std::string>& files, const std::vector<std::string>& models,
                    const FitOptions& options, FitStore& store, bool quiet) {
  std::map<std::string, std::string> options_text; // of each model
  for (const std::string& model : models)
    options_text[model] = with_shaders(options_json(options), model);
  BatchResult result;
  std::atomic<std::size_t> done = 0;
  std::mutex failing;
  Progress progress("fits", files.size() * models.size(), quiet);
  for (const std::string& file : files) {
    StoredFit row;
    row.file = file;
    row.material = fs::path(file).stem().string();
    row.version = version();
    const auto store_failure = [&](const std::string& model, const std::string& content,
                                   const std::string& why) {
      StoredFit f = row;
      f.key = {content, model, options_text.at(model)};
      f.failure = why;
      store.put(f);
      progress.advance();
      const std::lock_guard lock(failing);
      result.failures.push_back(std::move(f));
    };
    std::shared_ptr<const MeasuredBsdf> measured;
    std::unique_ptr<const FitData> data; // what all fits to one measurement share
    std::vector<std::string> open;
    try {
      row.key.content = content_hash(file);
      for (const std::string& model : models)
        if (!store.contains({row.key.content, model, options_text.at(model)})) open.push_back(model);
      result.skipped += models.size() - open.size();
      progress.advance(models.size() - open.size());
      if (open.empty()) continue;
      measured = read_measured(file);
      data = std::make_unique<const FitData>(*measured);
    } catch (const Error& e) {
      for (const std::string& model : open.empty() ? models : open)
        store_failure(model, row.key.content.empty() ? file : row.key.content, e.what());
      continue;
    }
    parallel_for(open.size(), [&](std::size_t i) {
      if (stop_requested()) return;
      FitOptions one = options;
      one.model = open[i];
      try {
        const FitResult fitted = fit(*data, one);
        StoredFit f = row;
        f.key = {row.key.content, open[i], options_text.at(open[i])};
        f.result = to_json(fitted);
        f.seconds = fitted.seconds;
        store.put(f);
        ++done;
        progress.advance();
      } catch (const Error& e) {
        if (!stop_requested()) store_failure(open[i], row.key.content, e.what());
      }
    });
    if (stop_requested()) break;
  }
  result.done = done, result.failed = result.failures.size(), result.stopped = stop_requested();
  return result;
}

} // namespace nacre
