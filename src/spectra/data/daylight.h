#pragma once
#include <array>

namespace nacre::data {

/// Mean S0 and eigenvectors S1, S2 of daylight at 360, 370, ..., 830 nm.
/// Source: Judd, MacAdam, Wyszecki 1964; CIE 015:2018, table 6.
extern const std::array<std::array<double, 48>, 3> daylight_components_10nm;

} // namespace nacre::data
