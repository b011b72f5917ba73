#pragma once
// Nacre's own container of measured scattering, `.nbsdf`: whatever was read, kept without loss, and where it
// came from. An HDF5 file that any tool for these opens.
//
// Attributes of the root (text, but for `version`):
//   format          "nacre-nbsdf"
//   version         1, a whole number
//   content         "merl", "file" or "samples": which of the groups below there is
//   kind            what the measurement says it is
//   software        the program that wrote the container, with its version
//   source_file     name of the file that was read, without folders, or ""
//   source_format   its format, a name of measured/formats.h, or ""
//   value           "f in 1/sr, without the cosine"
//   directions      "unit vectors in the local frame, away from the surface: wo to the viewer, wi to the
//   light, z
//                   the normal, x the tangent"
// Array `facts` (uint8): UTF-8 lines "label: text".
//
// Group `merl`, a table over half and difference angles (measured/merl_table.h has the nodes):
//   rgb    float32 [theta_h][theta_d][phi_d][3], linear sRGB; 0 in holes
//   state  uint8 [theta_h][theta_d][phi_d]: 0 a hole, 1 measured, 2 filled in
// Group `file`, anything that was read from a file of another format:
//   bytes  uint8, the file itself: read again by its own reader, it evaluates as before
//   attributes `format`, a name of measured/formats.h, and `name`
// Group `samples`, of what was neither; they are interpolated as measured/scattered_bsdf.h says:
//   wo, wi  float32 [n][3]
//   f       float32 [n][channels]
//   weight  float64 [n]: share of the pairs of directions a sample stands for, not normalised
//   wavelengths_nm  float64 [channels], of spectral samples
//   attributes `channels`, "grey", "rgb" (linear sRGB) or "spectral", and `isotropic`, 0 or 1
//
// Tables are kept bit for bit, files byte for byte, samples bit for bit (their weights are for other
// programs: read back, scattered samples weigh the same). The library writes; files are read by
// measured/hdf5_file.h.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace nacre {

/// @throws Error with the place
std::shared_ptr<const MeasuredBsdf> parse_container(std::span<const std::uint8_t> bytes,
                                                    std::string_view name);
/// The attributes and facts of a container, for people. @throws Error
std::vector<std::pair<std::string, std::string>> container_facts(std::span<const std::uint8_t> bytes,
                                                                 std::string_view name);
/// The bytes of a container: of a MERL table its entries; of what read_measured read the file, which must
/// still be there as it was; of networks and of WINDOW's data the file they would be written to; else the
/// samples.
/// @throws Error if the file changed
std::vector<std::uint8_t> encode_container(const MeasuredBsdf& measured);

} // namespace nacre
