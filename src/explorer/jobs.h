#pragma once
// Who works on which request: a few threads a page for what is answered at once, a thread of its own for each
// long work. So a fit never makes a slider wait, and nothing that one page asks for makes another wait.

#include "explorer/desk.h"
#include "explorer/protocol.h"

#include <condition_variable>
#include <deque>
#include <map>
#include <optional>
#include <thread>

namespace nacre {

/// What all pages share.
struct Workshop {
  Folder folder;
  MaterialCache materials;
  Start start;
};

class Jobs;

/// One page: its requests go in, its messages come out. The functions are called from any thread.
class PageJobs : public std::enable_shared_from_this<PageJobs> {
public:
  /// @param send  called from worker threads, one call at a time for a page; `droppable` messages, of
  /// progress, may be left out where the page is slow to take them
  using Send = std::function<void(Message message, bool droppable)>;
  PageJobs(Jobs& jobs, Send send);

  /// A text message of the page, valid or not. Answers come later, through `send`.
  void receive(std::string_view text);
  /// The page is gone: nothing is sent any more, and its work is cancelled.
  void close();

private:
  friend class Jobs;
  struct Task {
    Request request;
    const Handler* handler;
    std::atomic<bool> cancelled{false};
    /// Nobody waits for what was done until then: the work ends wherever it is. Of what is not slow the same
    /// as `cancelled`.
    std::atomic<bool> abandoned{false};
    bool is_slow() const { return handler && handler->pace == Pace::slow; }
    void cancel() {
      // Long work keeps what it has and ends; the second time it is told so it ends at once.
      if (cancelled.exchange(true) || !is_slow()) abandoned = true;
    }
  };
  /// Requests of which only so many run at once.
  struct Lane {
    int most = 1, running = 0;
    std::deque<std::shared_ptr<Task>> waiting;
  };
  Lane& lane_of(const Task& task) { return task.handler->pace == Pace::brief ? brief_ : quick_; }
  void begin(std::shared_ptr<Task> task);
  void run(const std::shared_ptr<Task>& task);
  void say(Message message, bool droppable = false);
  void cancel(std::int64_t of, std::int64_t id);
  void run_slow(std::shared_ptr<Task> task);

  Jobs& jobs_;
  std::mutex sending_;
  Send send_; ///< empty after `close`; guarded by sending_
  PictureStore pictures_;
  std::mutex mutex_;                                   ///< guards what follows
  std::map<std::int64_t, std::shared_ptr<Task>> open_; ///< begun or waiting, by id
  std::map<std::string, bool> busy_;                   ///< slots of which a request runs
  std::map<std::string, std::shared_ptr<Task>> next_;  ///< the one that waits for its slot
  Lane brief_, quick_;
  int slow_ = 0;
  bool closed_ = false;
};

class Jobs {
public:
  /// @param at_once  requests that are answered at once for one page; at least 1
  explicit Jobs(Workshop& workshop, int at_once = 2);
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;
  /// Waits for what is under way to end; pages have been closed, and with that it is cancelled.
  ~Jobs();

  std::shared_ptr<PageJobs> open(PageJobs::Send send);

private:
  friend class PageJobs;
  void enqueue(std::function<void()> work);
  void work();
  void began_slow();
  void ended_slow();

  Workshop& workshop_;
  const int at_once_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> queue_;
  std::size_t idle_ = 0; ///< threads that wait for work
  int slow_ = 0;         ///< threads of long work that have not ended
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

} // namespace nacre
