#include "explorer/explorer.h"

#include "core/parallel.h"

namespace nacre {
namespace {

class JobsConnection final : public PageConnection {
public:
  explicit JobsConnection(std::shared_ptr<PageJobs> jobs) : jobs_(std::move(jobs)) {}
  void receive(std::string_view text) override { jobs_->receive(text); }
  void close() override { jobs_->close(); }

private:
  std::shared_ptr<PageJobs> jobs_;
};

} // namespace

Explorer::Explorer(const ExplorerOptions& options)
    : shop_{Folder(options.folder), {}, options.start}, fence_({shop_.folder.root(), shop_.folder.uploads()}),
      jobs_(shop_, std::clamp(thread_count(), 2, 4)) {
  // What is wrong with the command line is said on the command line.
  for (const std::string& material : shop_.start.materials)
    shop_.materials.resolve(start_material(material, shop_.folder), shop_.folder);
  if (!shop_.start.scene.empty()) read_text_file(shop_.start.scene);
  ServerOptions server;
  server.port = options.port;
  server.page = page_files();
  server.open = [this](PageJobs::Send send) {
    return std::make_unique<JobsConnection>(jobs_.open(std::move(send)));
  };
  server.upload_path = [this](std::string_view name) { return shop_.folder.upload_path(name); };
  server.uploaded_name = [this](const std::filesystem::path& path) { return shop_.folder.name_of(path); };
  server_ = std::make_unique<Server>(std::move(server));
}

Explorer::~Explorer() { server_.reset(); }

void Explorer::run() {
  // A signal handler can set a flag and no more; somebody looks at it.
  std::thread watcher([this] {
    while (!stopping_ && !stop_requested())
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    server_->stop();
  });
  server_->run();
  stopping_ = true;
  watcher.join();
}

void Explorer::stop() { stopping_ = true; }

} // namespace nacre
