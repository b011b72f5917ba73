#pragma once
// Files of neural reflectance (measured/neural_brdf.h) as its authors publish them.
//
// `.h5`: weights saved by Keras. Arrays `GROUP/kernel:0` (inputs x outputs) and `GROUP/bias:0`, one group a
// layer, at the root or under `model_weights`; layers in the order of the attribute `layer_names`, which
// these files have, else by the number at the end of their names.
// `.npy`: arrays of NumPy (format 1.0 to 3.0), float32 or float64, written one after another: kernel and bias
// of the first layer, of the second, and so on. The authors' converter writes six files instead,
// MATERIAL_fc1.npy, MATERIAL_b1.npy to MATERIAL_b3.npy; to name one of them is to read all, joined in that
// order.

#include "measured/neural_brdf.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// @throws Error with the byte offset
NeuralBrdf parse_nbrdf_h5(std::span<const std::uint8_t> bytes, std::string_view name);
NeuralBrdf parse_nbrdf_npy(std::span<const std::uint8_t> bytes, std::string_view name);

/// The bytes of `path`, or of all six files if it is named as one of them. @throws Error naming what is
/// missing
std::vector<std::uint8_t> read_nbrdf_npy_files(const std::string& path);
/// Weights as Keras saves them, layers dense_1, dense_2 and so on.
std::vector<std::uint8_t> encode_nbrdf_h5(const NeuralBrdf& network);
/// All layers as arrays one after another.
std::vector<std::uint8_t> encode_nbrdf_npy(const NeuralBrdf& network);

} // namespace nacre
