#pragma once
// HTTP and WebSocket on the loopback interface: carries messages and knows nothing of what they say.

#include "explorer/message.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace nacre {

/// A file of the page.
struct PageFile {
  std::string_view path; ///< "/assets/nacre.js"; the page itself is "/"
  std::string_view bytes;
};
/// The page that was built into the program.
const std::vector<PageFile>& page_files();

/// One open WebSocket, as who answers sees it.
class PageConnection {
public:
  virtual ~PageConnection() = default;
  /// A text message of the page. Called on the server's thread: must not work for long.
  virtual void receive(std::string_view text) = 0;
  /// The page is gone.
  virtual void close() = 0;
};

struct ServerOptions {
  int port = 0; ///< 0: any free one
  std::vector<PageFile> page;
  std::size_t max_message = 64u << 20;   ///< bytes of a message of a page
  std::uint64_t max_upload = 256u << 20; ///< bytes of a dropped file
  std::size_t max_unsent =
      256u << 20; ///< bytes waiting for a page that does not take them; then it is closed
  int max_pages = 32;
  /// A page has connected. `send` may be called from any thread until `close` has returned. Droppable
  /// messages are left out while others wait.
  std::function<std::unique_ptr<PageConnection>(std::function<void(Message, bool droppable)> send)> open;
  /// Where a dropped file of this name is written to. @throws Error for a name that cannot be
  std::function<std::filesystem::path(std::string_view name)> upload_path;
  /// What the page is told of a file that has arrived.
  std::function<std::string(const std::filesystem::path&)> uploaded_name;
};

class Server {
public:
  /// Listens from now on. @throws Error if the port is taken
  explicit Server(ServerOptions options);
  ~Server();
  int port() const;
  const std::string& token() const;
  /// With the token: what a browser opens.
  std::string address() const;
  /// Serves until `stop`; on the calling thread.
  void run();
  /// From any thread.
  void stop();

  struct Impl; ///< of the source alone

private:
  std::unique_ptr<Impl> impl_;
};

} // namespace nacre
