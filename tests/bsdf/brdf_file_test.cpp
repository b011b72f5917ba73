// Disney's .brdf files: what of them is read, and what is said of the rest.
#include "bsdf/brdf_file.h"

#include "core/error.h"
#include "core/random.h"
#include "core/scratch_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

namespace nacre {
namespace {

using testing::HasSubstr;

constexpr const char* shader = "::begin shader\nvec3 BRDF() { return vec3(1); }\n::end shader\n";

std::string message_of(const std::string& text) {
  try {
    parse_brdf_file(text, "t.brdf");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(BrdfFile, HoldsParametersAndAShader) {
  const BrdfFile file = parse_brdf_file(std::string("\n# words\nanalytic\r\n\n::begin parameters\n"
                                                    "float  rough .01 1.5 +.5f # of the surface\n"
                                                    "bool on 1\n\tcolor c .8 .2 1.5\n::end parameters\n"
                                                    "::begin isFuncBlinn\nanything\n::end isFuncBlinn\n") +
                                            shader,
                                        "t.brdf");
  ASSERT_EQ(file.parameters.size(), 3u);
  EXPECT_EQ(file.parameters[0].name, "rough");
  EXPECT_EQ(file.parameters[0].lo, 0.01);
  EXPECT_EQ(file.parameters[0].hi, 1.5);
  EXPECT_EQ(file.parameters[0].initial[0], 0.5);
  EXPECT_EQ(file.parameters[0].line, 6);
  EXPECT_EQ(file.parameters[1].form, BrdfFile::Parameter::Form::truth);
  EXPECT_EQ(file.parameters[1].initial[0], 1);
  EXPECT_EQ(file.parameters[2].initial, (std::array{0.8, 0.2, 1.5}));
  EXPECT_EQ(file.parameters[2].hi, 1.5); // as bright as the file itself has it
  EXPECT_EQ(file.shader, "vec3 BRDF() { return vec3(1); }\n");
  EXPECT_EQ(file.shader_line, 14);
}

// Some public files begin outside of their own range.
TEST(BrdfFile, ARangeIsWidenedToItsDefault) {
  const BrdfFile file = parse_brdf_file(
      std::string("analytic\n::begin parameters\nfloat n 1 10 100\n::end parameters\n") + shader, "t.brdf");
  EXPECT_EQ(file.parameters[0].hi, 100);
}

TEST(BrdfFile, ErrorsNameLineAndColumn) {
  const auto with = [](const std::string& line) {
    return "analytic\n::begin parameters\n" + line + "\n::end parameters\n" + shader;
  };
  EXPECT_THAT(message_of(""), HasSubstr("t.brdf:1:1: empty"));
  EXPECT_THAT(message_of("measured\n"), HasSubstr("t.brdf:1:1: expected 'analytic'"));
  EXPECT_THAT(message_of("analytic\n"), HasSubstr("no '::begin shader'"));
  EXPECT_THAT(message_of("analytic\n::begin shade\n::end shade\n"),
              HasSubstr("no '::begin shader': a .brdf file needs a shader; line 2 has '::begin shade'"));
  EXPECT_THAT(message_of("analytic\n::begn shader\n::end shader\n"), HasSubstr("line 2 has '::begn'"));
  EXPECT_THAT(message_of("analytic\n\n::begin shader\nvec3\n"),
              HasSubstr("t.brdf:3:1: '::begin shader' without"));
  EXPECT_THAT(message_of("analytic\n::begin parameters\nfloat a 0 1 0\n"),
              HasSubstr("t.brdf:2:1: '::begin parameters' without"));
  EXPECT_THAT(message_of(with("flot a 0 1 0")),
              HasSubstr("t.brdf:3:1: unknown type 'flot' (did you mean 'float'?)"));
  EXPECT_THAT(message_of(with("float a 0 1")),
              HasSubstr("expected 'float NAME MIN MAX DEFAULT', found 4 words"));
  EXPECT_THAT(message_of(with("float a 0 one 0")), HasSubstr("t.brdf:3:11: expected a number, found 'one'"));
  EXPECT_THAT(message_of(with("float a 0 nan 0")), HasSubstr("expected a number"));
  EXPECT_THAT(message_of(with("float a 1e300 1 0")), HasSubstr("expected a number"));
  EXPECT_THAT(message_of(with("float a 2 1 1")), HasSubstr("the range [2, 1] of a is empty"));
  EXPECT_THAT(message_of(with("float 2a 0 1 0")), HasSubstr("t.brdf:3:7: '2a' is no name"));
  EXPECT_THAT(message_of(with("float a 0 1 0\nbool a 1")), HasSubstr("t.brdf:4:6: a second parameter 'a'"));
  EXPECT_THAT(message_of(std::string("analytic\n") + shader + shader), HasSubstr("a second shader"));
}

// As in BRDF Explorer, which looks for nothing there.
TEST(BrdfFile, WhatOtherProgramsAddIsPassedOver) {
  const BrdfFile file =
      parse_brdf_file(std::string("\xEF\xBB\xBF"
                                  "bparam\nby somebody\n::begin parameters\n"
                                  "float a 0 1 0.5 of the surface\nbool b 1 1\ncolor c 1 1 1 0.5\n"
                                  "::end parameters\n::begin notes\nfloat x\n::end notes\n: end\n") +
                          shader + "the end\n",
                      "t.brdf");
  ASSERT_EQ(file.parameters.size(), 3u);
  EXPECT_EQ(file.parameters[2].name, "c");
  EXPECT_EQ(file.shader_line, 13);
}

TEST(BrdfFile, AFileThatIsTooLargeIsRefusedUnread) {
  const ScratchFolder folder;
  const std::string path = folder.write("large.brdf", "analytic\n");
  std::filesystem::resize_file(path, std::uintmax_t(1) << 40); // most of it nowhere on the disk
  EXPECT_THAT([&] { read_brdf_text(path); },
              testing::ThrowsMessage<Error>(HasSubstr("1099511627776 bytes, more than the 1048576")));
  const std::string pipe = folder / "pipe.brdf"; // of which nobody writes the other end
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT([&] { read_brdf_text(pipe); }, testing::ThrowsMessage<Error>(HasSubstr("no plain file")));
  EXPECT_EQ(read_brdf_text(folder.write("small.brdf", shader)), shader);
  EXPECT_THAT(message_of(std::string(2 << 20, 'x')), HasSubstr("more than the 1048576"));
}

TEST(BrdfFile, MessagesHoldNothingThatATerminalObeys) {
  EXPECT_THAT(message_of("\x1b[2J\a\xff\xc2\x9bz\n"), HasSubstr("found '\\x1B[2J\\x07\\xFF\\xC2\\x9Bz'"));
  EXPECT_THAT(message_of("schön\n"), HasSubstr("found 'schön'"));
}

TEST(BrdfFile, DamagedTextIsAnErrorOrAFileNeverACrash) {
  const std::string good =
      std::string("analytic\n::begin parameters\nfloat a 0 1 0.5\ncolor c 1 1 1\n::end parameters\n") +
      shader;
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string bad = good;
    for (int k = 0; k <= i % 4; ++k)
      bad[hash(1, i, k) % bad.size()] = char(hash(2, i, k) % 256);
    if (i % 3 == 0) bad.resize(hash(3, i) % bad.size());
    refused += message_of(bad) != "no error";
  }
  EXPECT_GT(refused, 5000);
}

} // namespace
} // namespace nacre
