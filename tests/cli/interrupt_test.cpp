// Ctrl-C and time limits: what is done is kept.

#include "run_command.h"
#include "small_input.h"

#include <nlohmann/json.hpp>

namespace nacre {
namespace {

// The status is that of a command that Ctrl-C ended, so that a script stops too; the picture is whole.
TEST(Interrupt, CtrlCKeepsWhatIsDone) {
  const ScratchFolder folder;
  RunOptions options;
  options.interrupt_after = 0.3;
  const Outcome o = nacre_command(
      {"--threads", "1", "render", small_scene(folder), "-o", folder / "a.exr", "--spp", "1000000", "--json"},
      options);
  EXPECT_FALSE(o.timed_out);
  EXPECT_EQ(o.status, 130) << "signal " << o.signal << "\n" << o.err;
  const auto json = nlohmann::json::parse(o.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << o.out << o.err;
  EXPECT_EQ(json["complete"], false);
  EXPECT_GE(json["samples_per_pixel"].get<double>(), 1);
  EXPECT_LT(json["samples_per_pixel"].get<double>(), 1000000);
  const Image image = read_exr(folder / "a.exr");
  EXPECT_EQ(image.width, 32);
  double sum = 0;
  for (const float x : image.data)
    sum += x;
  EXPECT_GT(sum, 0);
  EXPECT_TRUE(std::isfinite(sum));
}

// SIGKILL leaves a program no last word: every fit that ended before is in the database, and only the others
// are done by the next call.
TEST(Interrupt, ABatchOfFitsGoesOnAfterAKill) {
  const ScratchFolder folder;
  std::vector<std::string> command{
      "--threads", "1", "fit", small_table(folder), "--database", folder / "fits.sqlite", "--json"};
  for (const char* model : {"lambert", "oren_nayar", "ward+lambert", "ggx_schlick+lambert", "disney_2012",
                            "ggx_schlick+ggx_schlick+lambert"})
    command.insert(command.end(), {"--model", model});
  RunOptions options;
  options.interrupt_after = 0.25;
  options.interrupt_by = SIGKILL;
  options.seconds = 120;
  const Outcome killed = nacre_command(command, options);
  ASSERT_EQ(killed.signal, SIGKILL) << "it was done before it was killed\n" << killed.err;
  options.interrupt_after = 0;
  const auto whole = nlohmann::json::parse(expect_success(command, options).out);
  EXPECT_GE(whole["skipped"].get<int>(), 1);
  EXPECT_GE(whole["done"].get<int>(), 1);
  EXPECT_EQ(whole["skipped"].get<int>() + whole["done"].get<int>(), whole["models"].size());
  EXPECT_EQ(whole["failed"], 0);
}

TEST(Interrupt, ATimeLimitIsASuccess) {
  const ScratchFolder folder;
  expect_success({"render", small_scene(folder), "-o", folder / "a.exr", "--time", "0.2"});
  EXPECT_EQ(read_exr(folder / "a.exr").height, 24);
}

} // namespace
} // namespace nacre
