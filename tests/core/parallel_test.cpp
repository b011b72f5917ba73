#include "core/parallel.h"

#include "core/error.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace nacre {
namespace {

using testing::ContainsRegex;

/// Loops run on this many threads while it lives.
struct Threads {
  explicit Threads(int n) { set_thread_count(n); }
  ~Threads() { set_thread_count(0); }
};

std::vector<double> series(std::size_t n) {
  std::vector<double> out(n);
  parallel_for(n, [&](std::size_t i) {
    for (int k = 1; k < 50; ++k)
      out[i] += std::sin(double(i) * k) / k;
  });
  return out;
}

TEST(ParallelFor, CallsEveryIndexOnce) {
  for (const std::size_t n : {0u, 1u, 2u, 1000u, 100'000u}) {
    std::vector<std::atomic<int>> calls(n);
    parallel_for(n, [&](std::size_t i) { ++calls[i]; });
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_EQ(calls[i], 1) << i << " of " << n;
  }
}

TEST(ParallelFor, GivesTheSameBitsForAnyNumberOfThreads) {
  std::vector<double> reference;
  {
    const Threads one(1);
    reference = series(20'000);
  }
  for (const int n : {2, 3, 8}) {
    const Threads several(n);
    EXPECT_EQ(thread_count(), n);
    EXPECT_EQ(series(20'000), reference) << n << " threads";
  }
}

TEST(ParallelFor, RunsOnAsManyThreadsAsAsked) {
  // Every body waits until the others have begun: with fewer threads than asked the count stays lower.
  const Threads four(4);
  std::atomic<int> begun{0};
  std::atomic<bool> together{false};
  parallel_for(64, [&](std::size_t) {
    ++begun;
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (!together && std::chrono::steady_clock::now() < until)
      if (begun >= 4) together = true;
  });
  EXPECT_TRUE(together);
}

TEST(ParallelFor, OneThreadIsTheCallingOne) {
  const Threads one(1);
  std::set<std::thread::id> ids;
  parallel_for(1000, [&](std::size_t) { ids.insert(std::this_thread::get_id()); });
  EXPECT_EQ(ids, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(ParallelFor, AnExceptionComesOutAndTheNextLoopWorks) {
  const Threads four(4);
  std::string message;
  try {
    parallel_for(10'000, [](std::size_t i) {
      if (i == 777) throw Error("sample 777 is bad");
    });
  } catch (const Error& e) {
    message = e.what();
  }
  EXPECT_EQ(message, "sample 777 is bad");
  std::atomic<int> calls{0};
  parallel_for(100, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, 100);
}

TEST(ParallelFor, MayBeNested) {
  const Threads four(4);
  std::vector<std::size_t> sums(50);
  parallel_for(sums.size(), [&](std::size_t i) {
    std::vector<std::size_t> inner(100);
    parallel_for(inner.size(), [&](std::size_t j) { inner[j] = i * j; });
    for (const std::size_t x : inner)
      sums[i] += x;
  });
  for (std::size_t i = 0; i < sums.size(); ++i)
    EXPECT_EQ(sums[i], i * 4950);
}

TEST(OwnLoops, DoNotWaitBehindALongLoop) {
  // Two seconds of work for every thread, in pieces of 50 ms; where loops share their threads, another one
  // begins when it is over.
  using Clock = std::chrono::steady_clock;
  std::atomic<bool> begun{false};
  std::atomic<int> left{40 * thread_count()};
  std::thread other([&] {
    parallel_for(std::size_t(left), [&](std::size_t) {
      begun = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      --left;
    });
  });
  while (!begun)
    std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  std::atomic<int> calls{0};
  const auto start = Clock::now();
  {
    const OwnLoops urgent(OwnLoops::Priority::urgent);
    parallel_for(8, [&](std::size_t) {
      parallel_for(4, [&](std::size_t) { ++calls; }); // those inside are urgent too
    });
  }
  const std::chrono::duration<double> waited = Clock::now() - start;
  EXPECT_EQ(calls, 32);
  EXPECT_GT(left, 10 * thread_count()) << "after " << waited.count() << " s";
  other.join();
}

TEST(ThreadCount, ZeroIsAllCoresAndNonsenseIsRefused) {
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1);
  EXPECT_THROW(set_thread_count(-1), Error);
  EXPECT_THROW(set_thread_count(1'000'000'000), Error);
}

// Each of these runs in a process of its own: what a signal does cannot be undone.
class CtrlC : public testing::Test {
protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};
using CtrlCDeathTest = CtrlC;

TEST_F(CtrlCDeathTest, AsksFirstAndEndsTheProcessSecond) {
  const auto twice = [] {
    catch_ctrl_c();
    if (stop_requested()) std::exit(1);
    std::raise(SIGINT);
    if (!stop_requested()) std::exit(2);
    std::raise(SIGINT);
  };
  EXPECT_EXIT(twice(), testing::KilledBySignal(SIGINT), "press Ctrl-C again");
}

TEST_F(CtrlCDeathTest, EndsTheProcessAtOnceIfNotCaught) {
  EXPECT_EXIT(std::raise(SIGINT), testing::KilledBySignal(SIGINT), "");
}

TEST_F(CtrlCDeathTest, CatchingAgainForgetsTheRequest) {
  const auto again = [] {
    catch_ctrl_c();
    std::raise(SIGINT);
    catch_ctrl_c();
    std::exit(stop_requested() ? 1 : 0);
  };
  EXPECT_EXIT(again(), testing::ExitedWithCode(0), "");
}

TEST(Progress, SaysNothingAboutShortOrQuietWork) {
  testing::internal::CaptureStderr();
  {
    Progress brief("brief", 100), quiet("quiet", 100, true), nothing("nothing", 0);
    for (int i = 0; i < 100; ++i) {
      brief.advance();
      quiet.advance();
      nothing.advance();
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Progress, WritesPlainLinesToAFile) {
  testing::internal::CaptureStderr();
  {
    Progress progress("rendering", 4);
    progress.advance();
    std::this_thread::sleep_for(std::chrono::milliseconds(5100));
    progress.advance();
  }
  const std::string text = testing::internal::GetCapturedStderr();
  // Half is done after some 5 s: as much again is left.
  EXPECT_THAT(text, ContainsRegex("rendering: 50 %, [5-9]\\.[0-9] s so far, [5-9]\\.[0-9] s left\n"));
  EXPECT_THAT(text, ContainsRegex("rendering: stopped at 50 % after [5-9]\\.[0-9] s\n"));
  EXPECT_EQ(text.find('\r'), std::string::npos);
  EXPECT_EQ(text.find('\033'), std::string::npos);
}

} // namespace
} // namespace nacre
