#include "measured/hole_filling.h"

#include "core/error.h"
#include "core/random.h"
#include "measured/synthetic_tables.h"

#include <cstring>
#include <gtest/gtest.h>

namespace nacre {
namespace {

using IsHole = std::function<bool(int i, int j, int k)>;

/// The table with these entries gone, those below the horizon too.
MerlTable punched(const MerlTable& table, const IsHole& is_hole) {
  std::vector<MerlTable::Cell> cells(table.cells().begin(), table.cells().end());
  std::size_t at = 0;
  for (int i = 0; i < table.n_theta_h(); ++i)
    for (int j = 0; j < table.n_theta_d(); ++j)
      for (int k = 0; k < table.n_phi_d(); ++k, ++at)
        if (is_hole(i, j, k) || !above_horizon(table.node(i, j, k))) cells[at] = {};
  return MerlTable(table.n_theta_h(), table.n_theta_d(), table.n_phi_d(), std::move(cells));
}

/// Checks marks and measured entries, and returns the largest relative error of what was filled in.
double largest_error(const MerlTable& truth, const MerlTable& holes, const MerlTable& filled) {
  double largest = 0;
  std::size_t marks = 0;
  for (int i = 0; i < truth.n_theta_h(); ++i)
    for (int j = 0; j < truth.n_theta_d(); ++j)
      for (int k = 0; k < truth.n_phi_d(); ++k) {
        const bool wanted = holes.is_hole(i, j, k) && above_horizon(truth.node(i, j, k));
        EXPECT_EQ(filled.is_filled(i, j, k), wanted) << i << " " << j << " " << k;
        EXPECT_EQ(filled.is_hole(i, j, k), holes.is_hole(i, j, k) && !wanted) << i << " " << j << " " << k;
        if (!wanted) {
          EXPECT_EQ(std::memcmp(&filled.cell(i, j, k), &holes.cell(i, j, k), sizeof(MerlTable::Cell)), 0);
          continue;
        }
        ++marks;
        for (std::size_t c = 0; c < 3; ++c)
          largest = std::max(largest, std::abs(double(filled.cell(i, j, k)[c]) / truth.cell(i, j, k)[c] - 1));
      }
  EXPECT_EQ(filled.filled_count(), marks);
  return largest;
}

TEST(HoleFilling, OfScatteredHolesInASmoothTableIsNearTheTruth) {
  const MerlTable truth = glossy_table(0.3, 30, 36);
  const MerlTable holes =
      punched(truth, [](int i, int j, int k) { return unit_double(hash(1, i, j, k)) < 0.2; });
  const FilledTable filled = fill_holes(holes);
  EXPECT_EQ(filled.by_reciprocity, 0u); // it is built into a table of half the circle
  EXPECT_GT(filled.by_mirror_image, filled.by_extrapolation);
  // Neighbours differ by up to 10 % in phi_d and less in theta_d: a membrane errs by their second
  // differences.
  EXPECT_LT(largest_error(truth, holes, filled.table), 0.05);
}

TEST(HoleFilling, ReachesOutToGrazingAngles) {
  const MerlTable truth = glossy_table(0.3, 30, 36);
  const MerlTable holes =
      punched(truth, [](int i, int j, int) { return j >= 26 || (i >= 20 && i < 24 && j < 8); });
  const FilledTable filled = fill_holes(holes);
  EXPECT_EQ(filled.by_mirror_image, 0u);
  // Over the holes this table varies by up to 60 % with phi_d, of which rows near the horizon see only a
  // part.
  EXPECT_LT(largest_error(truth, holes, filled.table), 0.25);
}

TEST(HoleFilling, IsExactForAProductOfHalfAndDifferenceAngles) {
  const MerlTable truth =
      MerlTable::tabulate(24, 20, 24, [](double h, double d, double) -> std::array<double, 3> {
        const double f = std::exp(-3 * sqr(h)) * (0.04 + sqr(std::sin(d)));
        return {f, 2 * f, 0.5 * f};
      });
  // Whole corners are gone, but no row and no column: the product has no freedom left.
  const MerlTable holes = punched(truth, [](int i, int j, int) { return i > 3 && j > 4; });
  EXPECT_LT(largest_error(truth, holes, fill_holes(holes).table), 1e-4);
}

TEST(HoleFilling, TakesReciprocityFirstWhereTheWholeCircleIsMeasured) {
  const MerlTable truth =
      MerlTable::tabulate(6, 6, 360, [](double h, double d, double phi) -> std::array<double, 3> {
        const double f = (2 - h) * (1 + d) * (1.5 + std::sin(2 * phi)); // reciprocal, with a handedness
        return {f, f, f};
      });
  const MerlTable holes =
      punched(truth, [](int i, int j, int k) { return i == 2 && j == 2 && k >= 20 && k < 60; });
  const FilledTable filled = fill_holes(holes);
  EXPECT_EQ(filled.by_reciprocity, 40u);
  EXPECT_EQ(filled.by_mirror_image + filled.by_extrapolation, 0u);
  EXPECT_LT(largest_error(truth, holes, filled.table), 1e-6);
}

TEST(HoleFilling, StaysBetweenTheValuesThatAreKnown) {
  // Noise over five decades: extrapolation must not shoot up.
  const MerlTable truth =
      MerlTable::tabulate(12, 12, 24, [](double h, double d, double phi) -> std::array<double, 3> {
        const double f =
            std::pow(10.0, 5 * unit_double(hash(int(1e4 * h), int(1e4 * d), int(1e4 * phi))) - 3);
        return {f, f, f};
      });
  const MerlTable holes = punched(truth, [](int, int j, int) { return j >= 7; });
  const FilledTable filled = fill_holes(holes);
  for (const MerlTable::Cell& cell : filled.table.cells())
    if (cell[3] != 0) {
      EXPECT_GT(cell[0], 1e-5);
      EXPECT_LT(cell[0], 1e4);
    }
}

TEST(HoleFilling, LeavesBlackBlackAndATableWithoutValuesAnError) {
  const MerlTable black = punched(diffuse_table(0), [](int i, int, int) { return i == 3; });
  const FilledTable filled = fill_holes(black);
  EXPECT_GT(filled.table.filled_count(), 0u);
  for (const MerlTable::Cell& cell : filled.table.cells())
    EXPECT_EQ(cell[0], 0);
  EXPECT_THROW(fill_holes(MerlTable(2, 2, 2, std::vector<MerlTable::Cell>(8))), Error);
}

TEST(HoleFilling, KeepsTheMarksOfAnEarlierFilling) {
  const MerlTable holes = punched(diffuse_table(), [](int i, int j, int) { return i == 3 && j == 3; });
  const MerlTable once = fill_holes(holes).table;
  const FilledTable twice = fill_holes(once);
  EXPECT_EQ(twice.by_extrapolation, 0u);
  EXPECT_EQ(twice.table.filled_count(), once.filled_count());
  EXPECT_GT(once.filled_count(), 0u);
}

TEST(HoleFilling, FilledEntriesAreNoSamples) {
  const MerlTable holes = punched(diffuse_table(), [](int i, int j, int) { return i == 3 && j == 3; });
  EXPECT_EQ(fill_holes(holes).table.samples().size(), holes.samples().size());
}

} // namespace
} // namespace nacre
