#pragma once
// The explorer: a server on this machine, and the core behind it.

#include "core/file.h"
#include "explorer/jobs.h"
#include "explorer/server.h"

namespace nacre {

struct ExplorerOptions {
  std::filesystem::path folder = "."; ///< what lies below it may be opened
  Start start;
  int port = 0; ///< 0: any free one
};

class Explorer {
public:
  /// Listens from now on. @throws Error for a port that is taken, or a material or scene that cannot be read
  explicit Explorer(const ExplorerOptions& options);
  ~Explorer();
  std::string address() const { return server_->address(); }
  Server& server() { return *server_; }
  /// Serves until `stop` is called, from any thread, or stop_requested().
  void run();
  void stop();

private:
  Workshop shop_;
  ReadingFence fence_; ///< whatever a file names, nothing outside is read
  Jobs jobs_;
  std::unique_ptr<Server> server_; ///< before jobs_ end, pages are closed
  std::atomic<bool> stopping_{false};
};

} // namespace nacre
