#pragma once
// Materials as a page names them, resolved to what the core evaluates.

#include "bsdf/user_model.h"
#include "explorer/folder.h"
#include "measured/material_spec.h"

#include <mutex>
#include <nlohmann/json.hpp>

namespace nacre {

/// Keeps what was read and compiled lately: a slider must not read a file anew. Thread-safe. What is kept of
/// a file holds as long as its size and time of change do.
class MaterialCache {
public:
  /// {"text"}, {"file"}, {"brdf", "values"} or {"name", "lobes"} of docs/explorer-protocol.md.
  /// @throws Error
  std::shared_ptr<const MaterialSpec> resolve(const nlohmann::json& material, const Folder& folder);
  /// @throws Error with the line
  std::shared_ptr<const UserModel> compile(const std::string& source, const std::string& name);

private:
  struct Kept {
    std::string key;
    std::shared_ptr<const void> value;
  };
  /// The value kept under `key`, or made by `make` outside the lock.
  template <class T, class F>
  std::shared_ptr<const T> kept(const std::string& key, F make);
  std::shared_ptr<const MaterialSpec> from_file(const std::string& name, const Folder& folder);

  std::mutex mutex_;
  std::vector<Kept> kept_; ///< the newest last
};

/// Declarations of parameters, with `value` where a lobe is given.
nlohmann::json declarations(const ModelInfo& model,
                            const std::vector<std::array<double, 3>>* values = nullptr);

/// A model as `hello` lists it.
nlohmann::json model_json(const ModelInfo& model);

/// {"name", "lobes"} of a material of listed models, as `material` answers and `resolve` takes.
nlohmann::json resolved(const MaterialSpec& material);

} // namespace nacre
