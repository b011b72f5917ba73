#pragma once
#include <array>

namespace nacre::data {

/// Reflectance of the red and the green sRGB primary at 380, 385, ..., 780 nm; blue is 1 minus both.
/// Source: Mallett and Yuksel 2019, Spectral Primary Decomposition for Rendering with sRGB Reflectance,
/// supplement.
extern const std::array<std::array<float, 81>, 2> mallett_yuksel_5nm;

} // namespace nacre::data
