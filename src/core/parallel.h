#pragma once
// Parallel loops over all cores, with progress, and an orderly stop on Ctrl-C.

#include <cstddef>
#include <functional>
#include <string>

namespace nacre {

/// Number of threads parallel loops use from now on; 0 is all cores.
void set_thread_count(int threads);
int thread_count();

/// Calls `body(i)` for every i in [0, n) on all threads. What `body` computes may depend on i alone, never on the
/// thread or the order. The first exception thrown by a body is rethrown here.
void parallel_for(std::size_t n, const std::function<void(std::size_t)>& body);

/// True once the user has asked to stop (SIGINT). Long loops ask between units of work, keep what is done and return.
bool stop_requested();
/// Makes Ctrl-C set stop_requested() instead of ending the process; a second Ctrl-C ends it.
void catch_ctrl_c();

/// A progress line with time left: redrawn on a terminal, plain lines every few seconds otherwise, nothing if quiet.
/// Thread-safe. Goes to standard error.
class Progress {
public:
  Progress(std::string what, std::size_t total, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::size_t n = 1);

private:
  struct State;
  State* state_;
};

} // namespace nacre
