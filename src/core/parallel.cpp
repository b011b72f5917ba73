#include "core/parallel.h"

#include "core/cancellation.h"
#include "core/error.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <mutex>
#include <sys/ioctl.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>
#include <utility>

namespace nacre {
namespace {

/// Where loops run. The arena holds the number of threads (it may exceed the cores), the control lets the
/// library start that many.
struct Workers {
  explicit Workers(int count)
      : threads(count), control(tbb::global_control::max_allowed_parallelism, std::size_t(count)),
        arena(count) {}
  int threads;
  tbb::global_control control;
  tbb::task_arena arena;
};

std::mutex workers_mutex;
std::shared_ptr<Workers> workers;

std::shared_ptr<Workers> current_workers() {
  const std::lock_guard lock(workers_mutex);
  if (!workers) workers = std::make_shared<Workers>(tbb::info::default_concurrency());
  return workers;
}

} // namespace

void set_thread_count(int threads) {
  constexpr int most = 4096;
  if (threads < 0 || threads > most)
    throw Error(fmt::format("the number of threads must lie in 0 to {}, not {}", most, threads));
  if (threads == 0) threads = tbb::info::default_concurrency();
  const std::lock_guard lock(workers_mutex);
  if (!workers || workers->threads != threads) workers = std::make_shared<Workers>(threads);
}

int thread_count() { return current_workers()->threads; }

struct OwnLoops::Arena {
  tbb::task_arena arena;
};

namespace {

/// What the loops of a thread inherit, on whichever threads they run.
struct Surroundings {
  OwnLoops::Arena* arena = nullptr; ///< null: the one that all share
  const std::atomic<bool>* cancelled = nullptr;
};
thread_local Surroundings surroundings;

class Inside {
public:
  explicit Inside(const Surroundings& s) : before_(std::exchange(surroundings, s)) {}
  ~Inside() { surroundings = before_; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

private:
  Surroundings before_;
};

} // namespace

OwnLoops::OwnLoops(Priority priority)
    : arena_(new Arena{tbb::task_arena(current_workers()->threads, 1,
                                       priority == Priority::urgent ? tbb::task_arena::priority::high
                                                                    : tbb::task_arena::priority::normal)}),
      before_(std::exchange(surroundings.arena, arena_.get())) {}
OwnLoops::~OwnLoops() { surroundings.arena = before_; }

Cancellation::Cancellation(const std::atomic<bool>& flag)
    : before_(std::exchange(surroundings.cancelled, &flag)) {}
Cancellation::~Cancellation() { surroundings.cancelled = before_; }

void check_cancelled() {
  const std::atomic<bool>* flag = surroundings.cancelled;
  if (flag && flag->load(std::memory_order_relaxed)) throw Error("cancelled");
}

void parallel_for(std::size_t n, const std::function<void(std::size_t)>& body) {
  const auto held = current_workers();
  const Surroundings here = surroundings;
  tbb::task_arena& arena = here.arena ? here.arena->arena : held->arena;
  // Isolated: a thread that waits for this loop takes up no work of the loop around it. That work could ask
  // for the very table that is being built here, and would wait for itself.
  arena.execute([&] {
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(std::size_t(0), n, [&](std::size_t i) {
        const Inside inside(here);
        check_cancelled();
        body(i);
      });
    });
  });
}

namespace {

// A signal handler may touch lock-free atomics and little else.
std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_interrupt(int) {
  stop.store(true);
  constexpr char note[] = "\nstopping; press Ctrl-C again to end at once\n";
  // Nothing can be done in a handler about a standard error that takes no text.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, note, sizeof note - 1);
}

} // namespace

bool stop_requested() { return stop.load(std::memory_order_relaxed); }

void catch_ctrl_c() {
  stop.store(false);
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  // After the first signal the default action is back, so that the second ends the process.
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
}

namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

std::string duration_text(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  if (seconds < 60) return fmt::format("{:.0f} s", std::min(seconds, 59.0));
  const auto whole = static_cast<long long>(seconds);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02} h", whole / 3600, whole / 60 % 60, whole % 60);
}

bool stderr_is_terminal() {
  const char* term = std::getenv("TERM");
  return ::isatty(STDERR_FILENO) && term && std::strcmp(term, "dumb") != 0;
}

int terminal_columns() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

} // namespace

struct Progress::State {
  std::string what;
  std::size_t total;
  bool terminal = stderr_is_terminal();
  Clock::time_point start = Clock::now();
  std::atomic<std::size_t> done{0};
  std::atomic<Clock::rep> next_draw{0}; ///< time since `start` at which a line is due
  std::mutex drawing;
  bool drawn = false;

  Clock::duration pause() const {
    return terminal ? Clock::duration(std::chrono::milliseconds(100)) : std::chrono::seconds(5);
  }

  void draw(Clock::duration elapsed_time) {
    const double elapsed = Seconds(elapsed_time).count();
    const double share = std::min(1.0, double(done.load()) / double(total));
    const std::string left =
        share > 0 ? fmt::format("{} left", duration_text(elapsed * (1 - share) / share)) : "";
    const int percent = static_cast<int>(100 * share);
    drawn = true;
    if (!terminal) {
      fmt::print(stderr, "{}: {} %, {} so far, {}\n", what, percent, duration_text(elapsed), left);
      return;
    }
    const int room = terminal_columns() - static_cast<int>(what.size() + left.size()) - 14;
    const int width = std::clamp(room, 0, 40), full = static_cast<int>(share * width);
    const std::string bar =
        width >= 8 ? fmt::format("[{:#<{}}{:.<{}}] ", "", full, "", width - full) : std::string();
    fmt::print(stderr, "\r{} {}{:3} %  {}\033[K", what, bar, percent, left);
    std::fflush(stderr);
  }

  void finish() {
    if (!drawn) return;
    const std::string elapsed = duration_text(Seconds(Clock::now() - start).count());
    const char* begin = terminal ? "\r\033[K" : "";
    if (done >= total) {
      fmt::print(stderr, "{}{}: done in {}\n", begin, what, elapsed);
    } else {
      fmt::print(stderr, "{}{}: stopped at {} % after {}\n", begin, what,
                 static_cast<int>(100.0 * double(done) / double(total)), elapsed);
    }
  }
};

Progress::Progress(std::string what, std::size_t total, bool quiet) {
  if (quiet || total == 0) return;
  state_ = std::make_unique<State>();
  state_->what = std::move(what);
  state_->total = total;
  const Clock::duration first = state_->terminal ? std::chrono::milliseconds(500) : state_->pause();
  state_->next_draw = first.count();
}

Progress::~Progress() {
  if (state_) state_->finish();
}

void Progress::advance(std::size_t n) {
  if (!state_) return;
  State& s = *state_;
  s.done.fetch_add(n, std::memory_order_relaxed);
  const Clock::duration elapsed = Clock::now() - s.start;
  if (elapsed.count() < s.next_draw.load(std::memory_order_relaxed)) return;
  // Whoever comes first draws; nobody waits for a terminal.
  const std::unique_lock lock(s.drawing, std::try_to_lock);
  if (!lock || elapsed.count() < s.next_draw.load()) return;
  s.next_draw = (elapsed + s.pause()).count();
  s.draw(elapsed);
}

} // namespace nacre
