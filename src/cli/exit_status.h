#pragma once
// How commands end.

namespace nacre {

inline constexpr int exit_failure = 1;       ///< something given does not work
inline constexpr int exit_usage = 2;         ///< the command line is wrong
inline constexpr int exit_violated = 3;      ///< a law is violated
inline constexpr int exit_interrupted = 130; ///< Ctrl-C, as shells count it; what was done is written

/// Thrown by a command that has said all it has to say and ends with this status.
struct ExitStatus {
  int status;
};

} // namespace nacre
