#pragma once
// Scattering as XML of LBNL's WINDOW and of Radiance (measured/window_bsdf.h has the conventions).
//
// Of WindowElement/Optical/Layer, the first layer: `DataDefinition/IncidentDataStructure` is `Columns` (a
// value for each incident patch, row after row of outgoing ones), `Rows` (the other way), `TensorTree3` or
// `TensorTree4`; each `WavelengthData` names a `Wavelength` and has up to four `WavelengthDataBlock`s with
// their direction, bases and numbers. Read are the wavelengths Visible (or CIE-Y) with CIE-X and CIE-Z, or
// CIE-u and CIE-v; others (Solar, NIR) are named among the facts. Bases are the three of Klems and what the
// file defines. Numbers are f in 1/sr: the sum of a column times the projected solid angles is the share of
// light scattered. Negative ones count as 0. Source: BSDF-v1.4 of WINDOW's schema, and Radiance's bsdf
// library.

#include "measured/window_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace nacre {

/// True for an XML document with the root WindowElement.
bool recognises_window_xml(std::span<const std::uint8_t> bytes);
/// @throws Error with line and column
WindowBsdf parse_window_xml(std::span<const std::uint8_t> bytes, std::string_view name);

/// How far a tensor tree follows what it is made of: at every point that was looked at, every component (X,
/// Y, Z) is within `relative` of the cell's largest component or within `absolute`, but in cells of the
/// smallest size.
struct TensorTreeTolerance {
  double relative = 0.1;
  double absolute = 1e-3; ///< 1/sr
  int first_level = 0;    ///< halvings made everywhere; 0: 5 of rank 3, 4 of rank 4
  int last_level = 0;     ///< halvings at most; 0: 8 of rank 3, 6 of rank 4
};
/// Any measurement as a tensor tree, of rank 3 if it is isotropic, else of rank 4; holes as 0. Coloured ones
/// with CIE-u and CIE-v.
/// @throws Error for levels that are none, or if 2^20 cells are not enough
WindowBsdf make_tensor_tree(const MeasuredBsdf& measured, const TensorTreeTolerance& tolerance);
/// The same within 0.1 or 0.001/sr; within twice as much, and so on, if 2^20 cells are not enough.
WindowBsdf make_tensor_tree(const MeasuredBsdf& measured);
/// Any measurement as means over the patches of a basis, 3 x 3 x 3 x 3 points for each pair; holes as 0.
/// Coloured ones with CIE-X and CIE-Z.
WindowBsdf make_klems(const MeasuredBsdf& measured, const KlemsBasis& basis);

/// The bytes of a file: parse_window_xml gives the same numbers back.
std::vector<std::uint8_t> encode_window_xml(const WindowBsdf& bsdf);

} // namespace nacre
