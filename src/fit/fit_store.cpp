#include "fit/fit_store.h"

#include "core/error.h"
#include "core/file.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <sqlite3.h>

namespace nacre {
namespace {

constexpr int schema_version = 1;

} // namespace

/// A prepared statement, finalised when it leaves the scope.
struct FitStore::Statement {
  const FitStore& store;
  sqlite3_stmt* handle = nullptr;

  Statement(const FitStore& s, const char* sql) : store(s) {
    if (sqlite3_prepare_v2(s.database_, sql, -1, &handle, nullptr) != SQLITE_OK) s.fail("cannot be read");
  }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  ~Statement() { sqlite3_finalize(handle); }

  void bind(int i, const std::string& text) {
    sqlite3_bind_text(handle, i, text.data(), int(text.size()), SQLITE_TRANSIENT);
  }
  void bind(int i, double x) { sqlite3_bind_double(handle, i, x); }
  /// True while there are rows.
  bool step() {
    const int code = sqlite3_step(handle);
    if (code != SQLITE_ROW && code != SQLITE_DONE) store.fail("cannot be used");
    return code == SQLITE_ROW;
  }
  std::string text(int i) const {
    const auto* s = reinterpret_cast<const char*>(sqlite3_column_text(handle, i));
    return s ? std::string(s, std::size_t(sqlite3_column_bytes(handle, i))) : std::string();
  }
};

double StoredFit::error(const std::string& metric) const {
  if (result.is_object() && result.contains("fit")) {
    const auto& errors = result["fit"]["errors"];
    if (errors.is_object() && errors.contains(metric) && errors[metric].is_number())
      return errors[metric].get<double>();
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string options_json(const FitOptions& o) {
  nlohmann::json rules{{"shared", o.rules.shared}, {"freed", o.rules.freed}};
  for (const auto& bound : o.rules.bounds)
    rules["bounds"].push_back({bound.name, bound.lo, bound.hi});
  for (const auto& fixed : o.rules.fixed)
    rules["fixed"].push_back({fixed.name, fixed.value ? nlohmann::json(*fixed.value) : nlohmann::json()});
  return nlohmann::json{{"metric", metric_name(o.metric)},
                        {"starts", o.starts},
                        {"refined", o.refined},
                        {"seed", o.seed},
                        {"max_theta_deg", o.max_theta_deg},
                        {"theta_d_step", o.theta_d_step},
                        {"phi_d_step", o.phi_d_step},
                        {"isotropic", o.isotropic},
                        {"max_iterations", o.max_iterations},
                        {"screened", o.screened},
                        {"every_node", o.every_node},
                        {"loss", {loss_name(o.loss.kind), o.loss.scale}},
                        {"channel", o.channel},
                        {"rules", rules},
                        {"confidence", o.confidence},
                        {"kept_angles", o.kept_angles},
                        {"images", o.images},
                        {"environment", o.environment.empty() ? "" : content_hash(o.environment)}}
      .dump();
}

std::string content_hash(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::uint8_t b : bytes)
    hash = (hash ^ b) * 0x100000001b3u;
  return fmt::format("{:016x}-{}", hash, bytes.size());
}

FitStore::FitStore(const std::string& path) : path_(path) {
  if (sqlite3_open_v2(path.c_str(), &database_,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX,
                      nullptr) != SQLITE_OK) {
    const std::string reason = database_ ? sqlite3_errmsg(database_) : "out of memory";
    sqlite3_close(database_);
    throw Error::in_file(path, "the database of fits cannot be opened: " + reason);
  }
  sqlite3_busy_timeout(database_, 10000);
  try {
    int version = 0, tables = 0;
    if (Statement s(*this, "PRAGMA user_version"); s.step()) version = sqlite3_column_int(s.handle, 0);
    if (Statement s(*this, "SELECT count(*) FROM sqlite_master"); s.step())
      tables = sqlite3_column_int(s.handle, 0);
    if (tables > 0 && version != schema_version)
      throw Error::in_file(
          path,
          fmt::format("a database, but not one of fits of version {}: name another file", schema_version));
    run("PRAGMA journal_mode = WAL");
    run("CREATE TABLE IF NOT EXISTS fits (content TEXT NOT NULL, model TEXT NOT NULL, options TEXT NOT NULL, "
        "material TEXT NOT NULL, file TEXT NOT NULL, version TEXT NOT NULL, failure TEXT NOT NULL, result "
        "TEXT "
        "NOT NULL, seconds REAL NOT NULL, PRIMARY KEY (content, model, options))");
    run(fmt::format("PRAGMA user_version = {}", schema_version).c_str());
  } catch (...) {
    sqlite3_close(database_);
    throw;
  }
}

FitStore::~FitStore() { sqlite3_close(database_); }

void FitStore::fail(const std::string& what) const {
  throw Error::in_file(path_, fmt::format("the database of fits {}: {}", what, sqlite3_errmsg(database_)));
}

void FitStore::run(const char* sql) const {
  if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail("cannot be used");
}

bool FitStore::contains(const FitKey& key) const {
  Statement s(*this, "SELECT 1 FROM fits WHERE content = ? AND model = ? AND options = ?");
  s.bind(1, key.content), s.bind(2, key.model), s.bind(3, key.options);
  return s.step();
}

void FitStore::put(const StoredFit& fit) {
  Statement s(*this,
              "INSERT OR REPLACE INTO fits (content, model, options, material, file, version, failure, "
              "result, seconds) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
  s.bind(1, fit.key.content), s.bind(2, fit.key.model), s.bind(3, fit.key.options);
  s.bind(4, fit.material), s.bind(5, fit.file), s.bind(6, fit.version), s.bind(7, fit.failure);
  s.bind(8, fit.result.dump()), s.bind(9, fit.seconds);
  s.step();
}

void FitStore::forget_failures() { run("DELETE FROM fits WHERE failure != ''"); }

std::vector<StoredFit> FitStore::all() const {
  Statement s(*this,
              "SELECT content, model, options, material, file, version, failure, result, seconds FROM fits "
              "ORDER BY material, model, options, content");
  std::vector<StoredFit> fits;
  while (s.step()) {
    StoredFit f{{s.text(0), s.text(1), s.text(2)}, s.text(3), s.text(4), s.text(5), s.text(6), {}, 0};
    f.result = nlohmann::json::parse(s.text(7), nullptr, false);
    if (f.result.is_discarded())
      throw Error::in_file(path_, fmt::format("the fit of {} to {} holds no JSON", f.key.model, f.material));
    f.seconds = sqlite3_column_double(s.handle, 8);
    fits.push_back(std::move(f));
  }
  return fits;
}

} // namespace nacre
