#pragma once
// Work that somebody may call off from another thread.

#include <atomic>

namespace nacre {

/// While it lives, work that this thread begins ends with an Error soon after `flag` is set: parallel loops
/// look at it before each of their parts, and long work in one of them by check_cancelled().
class Cancellation {
public:
  /// @param flag  outlives this
  explicit Cancellation(const std::atomic<bool>& flag);
  ~Cancellation();
  Cancellation(const Cancellation&) = delete;
  Cancellation& operator=(const Cancellation&) = delete;

private:
  const std::atomic<bool>* before_;
};

/// @throws Error once the flag of the innermost Cancellation of this work is set; takes some nanoseconds
void check_cancelled();

} // namespace nacre
