#pragma once
// Parallel loops over all cores, with progress, and an orderly stop on Ctrl-C.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace nacre {

/// Number of threads parallel loops use from now on; 0 is all cores. Call it between loops, not inside one.
/// @throws Error if negative or absurd
void set_thread_count(int threads);
int thread_count();

/// Calls `body(i)` for every i in [0, n) on all threads. What `body` computes may depend on i alone, never on
/// the thread or the order. The first exception thrown by a body is rethrown here; calls not yet begun are
/// then left out. A body may itself call parallel_for. A Cancellation of the caller holds in all bodies.
void parallel_for(std::size_t n, const std::function<void(std::size_t)>& body);

/// While it lives, the loops that this thread begins, and those inside them, do not wait behind the loops of
/// other threads: they share the cores. Urgent ones go first, as for an answer that a person waits for while
/// long work is under way.
class OwnLoops {
public:
  enum class Priority { normal, urgent };
  explicit OwnLoops(Priority priority);
  ~OwnLoops();
  OwnLoops(const OwnLoops&) = delete;
  OwnLoops& operator=(const OwnLoops&) = delete;

  struct Arena; ///< of the source alone

private:
  std::unique_ptr<Arena> arena_;
  Arena* before_;
};

/// True once the user has asked to stop (SIGINT). Long loops ask between units of work, keep what is done and
/// return.
bool stop_requested();
/// Makes Ctrl-C set stop_requested() instead of ending the process; a second Ctrl-C ends it. A request made
/// before the call is forgotten.
void catch_ctrl_c();

/// A progress line with time left: redrawn on a terminal, plain lines every few seconds otherwise, nothing if
/// quiet or if the work is over in a moment. Thread-safe. Goes to standard error.
class Progress {
public:
  Progress(std::string what, std::size_t total, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::size_t n = 1);

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace nacre
