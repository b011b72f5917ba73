#pragma once
// Runs the nacre program as a user would, and keeps what it printed and how it ended.

#include "core/scratch_folder.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <poll.h>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <vector>

#include <gtest/gtest.h>

namespace nacre {

struct Outcome {
  int status = -1; ///< exit status; -1 if a signal ended it or the time was over
  int signal = 0;
  bool timed_out = false;
  std::string out, err;
};

struct RunOptions {
  double seconds = 30;        ///< a program that takes longer hangs
  rlim_t largest_file = 0;    ///< bytes; 0: no limit
  std::string stdout_to = ""; ///< a file instead of the pipe
  double interrupt_after =
      0; ///< seconds of processor time after which it gets Ctrl-C, once it listens; 0: never
  int interrupt_by = SIGINT;
};

/// Whether the process has a handler for Ctrl-C and has since used that much processor time.
inline bool is_at_work(pid_t child, double cpu_seconds) {
  std::ifstream status("/proc/" + std::to_string(child) + "/status");
  bool listens = false;
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("SigCgt:")) listens = std::stoull(line.substr(7), nullptr, 16) >> (SIGINT - 1) & 1;
  std::ifstream stat("/proc/" + std::to_string(child) + "/stat");
  std::string text((std::istreambuf_iterator<char>(stat)), {});
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string skipped;
  for (int i = 0; i < 11; ++i) // from the state to the one before utime
    fields >> skipped;
  double ticks = 0;
  fields >> ticks;
  return listens && ticks >= cpu_seconds * double(::sysconf(_SC_CLK_TCK));
}

inline Outcome nacre_command(const std::vector<std::string>& arguments, const RunOptions& options = {}) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::string> words{NACRE_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);

  std::array<std::array<int, 2>, 2> pipes;
  for (auto& p : pipes)
    if (::pipe2(p.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) { // nothing but system calls from here on
    const int to_file = options.stdout_to.empty()
                            ? -1
                            : ::open(options.stdout_to.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    ::dup2(to_file >= 0 ? to_file : pipes[0][1], STDOUT_FILENO);
    ::dup2(pipes[1][1], STDERR_FILENO);
    const rlimit limit{options.largest_file, options.largest_file};
    if (options.largest_file > 0) ::setrlimit(RLIMIT_FSIZE, &limit);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  for (const auto& p : pipes)
    ::close(p[1]);

  Outcome outcome;
  const auto end = Clock::now() + std::chrono::duration<double>(options.seconds);
  std::array<pollfd, 2> open{pollfd{pipes[0][0], POLLIN, 0}, pollfd{pipes[1][0], POLLIN, 0}};
  bool interrupted = options.interrupt_after <= 0;
  while (open[0].fd >= 0 || open[1].fd >= 0) {
    if (!outcome.timed_out && Clock::now() > end) {
      outcome.timed_out = true;
      ::kill(child, SIGKILL);
    }
    if (!interrupted && is_at_work(child, options.interrupt_after)) {
      interrupted = true;
      ::kill(child, options.interrupt_by);
    }
    ::poll(open.data(), open.size(), 20);
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (open[i].fd < 0 || open[i].revents == 0) continue;
      char buffer[65536];
      const ssize_t n = ::read(open[i].fd, buffer, sizeof buffer);
      if (n > 0)
        (i == 0 ? outcome.out : outcome.err).append(buffer, std::size_t(n));
      else
        ::close(std::exchange(open[i].fd, -1));
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

inline std::string spelled(const std::vector<std::string>& arguments) {
  std::string text = "nacre";
  for (const std::string& word : arguments)
    text += word.empty() ? " ''" : " " + word;
  return text;
}

/// Runs it and expects success, with nothing but warnings and progress on standard error.
inline Outcome expect_success(const std::vector<std::string>& arguments, const RunOptions& options = {}) {
  const Outcome o = nacre_command(arguments, options);
  EXPECT_FALSE(o.timed_out) << spelled(arguments);
  EXPECT_EQ(o.status, 0) << spelled(arguments) << "\nsignal " << o.signal << "\n" << o.err;
  return o;
}

/// Runs it and expects this exit status, nothing on standard output and one or two lines on standard error
/// that contain each of `parts`.
inline Outcome expect_failure(int status, const std::vector<std::string>& arguments,
                              const std::vector<std::string>& parts, const RunOptions& options = {}) {
  const Outcome o = nacre_command(arguments, options);
  const std::string context = spelled(arguments) + "\nsaid: " + o.err;
  EXPECT_FALSE(o.timed_out) << context;
  EXPECT_EQ(o.status, status) << context << "signal " << o.signal;
  EXPECT_EQ(o.out, "") << context;
  EXPECT_TRUE(o.err.starts_with("nacre: ")) << context;
  EXPECT_TRUE(o.err.ends_with("\n")) << context;
  EXPECT_LE(std::count(o.err.begin(), o.err.end(), '\n'), 2) << context;
  for (const std::string& part : parts)
    EXPECT_NE(o.err.find(part), std::string::npos) << "no '" << part << "' in: " << context;
  return o;
}

} // namespace nacre
