// Many fits in one file: what is stored comes back, what was done is not done again, what fails stops
// nothing.
#include "core/error.h"
#include "core/file.h"
#include "core/scratch_folder.h"
#include "fit/batch.h"
#include "fit/synthetic.h"
#include "measured/merl_table.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

struct Batch : testing::Test {
  ScratchFolder folder;
  FitOptions quick{.starts = 2, .refined = 1};
  std::string database() const { return folder / "fits.sqlite"; }
  std::string measured(const std::string& name, const std::string& material) {
    const std::string file = folder / (name + ".binary");
    write_merl(tabulate(material), file);
    return file;
  }
};

TEST_F(Batch, EveryFitIsARowThatComesBackWhole) {
  const std::string file = measured("gold", "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.3+lambert:reflectance=0.05");
  FitStore store(database());
  const BatchResult r = fit_all({file}, {"lambert", "ggx_schlick+lambert"}, quick, store, true);
  EXPECT_EQ(r.done, 2u);
  EXPECT_EQ(r.failed, 0u);
  const auto rows = FitStore(database()).all();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].key.model, "ggx_schlick+lambert");
  EXPECT_EQ(rows[0].material, "gold");
  EXPECT_EQ(rows[0].key.options, options_json(quick));
  // The row alone repeats the fit, and its material is one that Nacre reads.
  FitOptions again = quick;
  again.model = rows[0].key.model;
  const FitResult repeated = fit(*read_measured(rows[0].file), again);
  EXPECT_EQ(rows[0].error("log"), repeated.errors.log);
  EXPECT_NO_THROW(material_from_json(rows[0].result, "row"));
  EXPECT_GT(rows[1].error("log"), rows[0].error("log"));
}

TEST_F(Batch, WhatWasDoneIsNotDoneAgain) {
  const std::string file = measured("a", "lambert:reflectance=0.3");
  FitStore store(database());
  fit_all({file}, {"lambert"}, quick, store, true);
  const BatchResult more = fit_all({file}, {"lambert", "oren_nayar"}, quick, store, true);
  EXPECT_EQ(more.skipped, 1u);
  EXPECT_EQ(more.done, 1u);
  // Another seed is another fit, and so is an edited file.
  FitOptions other = quick;
  other.seed = 7;
  EXPECT_EQ(fit_all({file}, {"lambert"}, other, store, true).done, 1u);
  measured("a", "lambert:reflectance=0.4");
  EXPECT_EQ(fit_all({file}, {"lambert"}, quick, store, true).done, 1u);
  EXPECT_EQ(store.all().size(), 4u);
}

TEST_F(Batch, AFailureIsARowThatSaysWhyAndStopsNothing) {
  const std::string good = measured("good", "lambert:reflectance=0.3"), bad = folder / "bad.binary";
  write_file_atomically(bad, std::string_view("not a table"));
  FitStore store(database());
  const BatchResult r = fit_all({bad, good}, {"lambert", "smooth_conductor"}, quick, store, true);
  EXPECT_EQ(r.done, 1u);
  EXPECT_EQ(r.failed, 3u);
  EXPECT_EQ(r.failures.size(), 3u);
  for (const StoredFit& row : store.all()) {
    EXPECT_EQ(row.failure.empty(), row.material == "good" && row.key.model == "lambert");
    if (row.material == "bad") {
      EXPECT_THAT(row.failure, testing::HasSubstr("byte"));
    }
  }
  store.forget_failures();
  EXPECT_EQ(store.all().size(), 1u);
}

TEST_F(Batch, FoldersAreSearchedForMeasurements) {
  const std::string b = measured("b", "lambert:reflectance=0.3"),
                    a = measured("a", "lambert:reflectance=0.3");
  write_file_atomically(folder / "notes.txt", std::string_view("x"));
  EXPECT_THAT(measured_files({folder.path()}),
              testing::ElementsAre(testing::EndsWith("a.binary"), testing::EndsWith("b.binary")));
  EXPECT_THROW(measured_files({folder / "nothing"}), Error);
}

TEST_F(Batch, AnotherDatabaseIsRefusedAndLeftAlone) {
  write_file_atomically(folder / "text.sqlite", std::string_view("this is a text and not a database at all"));
  EXPECT_THROW(FitStore store(folder / "text.sqlite"), Error);
  EXPECT_EQ(read_text_file(folder / "text.sqlite"), "this is a text and not a database at all");
  EXPECT_THROW(FitStore store(folder / "no/such/folder/x.sqlite"), Error);
}

} // namespace
} // namespace nacre
