#pragma once
#include <array>

namespace nacre::data {

/// CIE 1931 2-degree colour matching functions xbar, ybar, zbar at 360, 365, ..., 830 nm.
/// Source: CIE 018:2019, table 6 (CIE 015:2018), every fifth entry.
extern const std::array<std::array<double, 95>, 3> cie_1931_5nm;

} // namespace nacre::data
