#pragma once
// Results of many fits in one SQLite file: a row a fit, with all that is needed to repeat it. A row is
// written as soon as its fit ends, in a transaction of its own: after a kill what was done is there, and only
// the rest is left to do.

#include "fit/fit.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

struct sqlite3;

namespace nacre {

/// What a fit is of. Two fits with the same key have the same result.
struct FitKey {
  std::string content; ///< content_hash of the measurement's file
  std::string model;   ///< as FitOptions::model
  std::string options; ///< JSON of the other options, see options_json
};

/// One row.
struct StoredFit {
  FitKey key;
  std::string material;  ///< the file's name without folder and ending
  std::string file;      ///< as it was given
  std::string version;   ///< of Nacre
  std::string failure;   ///< why there is no result; empty: there is one
  nlohmann::json result; ///< as to_json(FitResult); null after a failure
  double seconds = 0;

  /// E of the metric of that name; NaN if there is none.
  double error(const std::string& metric) const;
};

/// The options that change a fit's result, but for the model, as one line of JSON with sorted keys.
std::string options_json(const FitOptions& options);
/// 64-bit FNV-1a of a file's bytes and its length, as hexadecimal text. Tells edited files from those fitted
/// before; not meant against forgery. Source: Fowler, Noll, Vo, draft-eastlake-fnv.
std::string content_hash(const std::string& path);

class FitStore {
public:
  /// Opens the file, or makes it. @throws Error if it is no such database, or cannot be written
  explicit FitStore(const std::string& path);
  FitStore(const FitStore&) = delete;
  FitStore& operator=(const FitStore&) = delete;
  ~FitStore();

  bool contains(const FitKey& key) const;
  /// Replaces a row of the same key. Thread-safe. @throws Error if the disk is full or the file is locked
  void put(const StoredFit& fit);
  /// Forgets the failures among rows, so that they are tried again.
  void forget_failures();
  /// All rows, by material, then model. @throws Error where a row is not what this program writes
  std::vector<StoredFit> all() const;

private:
  struct Statement;
  [[noreturn]] void fail(const std::string& what) const;
  void run(const char* sql) const;

  std::string path_;
  sqlite3* database_ = nullptr;
};

} // namespace nacre
