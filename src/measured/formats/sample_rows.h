#pragma once
// Samples as lines of numbers: what ASTM and CSV files share. A line gives the angles of a pair of directions
// and values, in columns whose names say which is which.

#include "core/text_scanner.h"
#include "measured/scattered_bsdf.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// The lines of a text, each without its end; views into the text.
class TextLines {
public:
  TextLines(std::string_view text, std::string_view file) : text_(text), places_(text, file) {}
  /// The next line, or nothing at the end.
  std::optional<std::string_view> next();
  /// @param part  of the text. @throws Error with its line and column
  [[noreturn]] void fail_at(std::string_view part, std::string_view message) const {
    places_.fail_at(part, message);
  }
  /// @throws Error at the beginning of the text
  [[noreturn]] void fail(std::string_view message) const { places_.fail(message); }

private:
  std::string_view text_;
  TextScanner places_;
  std::size_t offset_ = 0;
};

std::string_view text_of(std::span<const std::uint8_t> bytes);
std::string_view trimmed(std::string_view s);
std::string lower_case(std::string_view s);
/// The parts between commas; without a comma, between blanks. Each trimmed, views into `line`.
void split_fields(std::string_view line, std::vector<std::string_view>& fields);
/// The wavelength that a name like "550nm" or "BRDF_550 nm" spells.
std::optional<double> wavelength_in(std::string_view name);

/// Which columns hold what.
struct SampleColumns {
  int theta_i = -1, phi_i = -1, theta_o = -1, phi_o = -1;
  std::vector<int> values;   ///< in the order of the channels
  int count = 0;             ///< columns of a line
  bool times_cosine = false; ///< values are f |cos theta_o|
  bool radians = false;
  bool transmits = false;      ///< theta_o up to 90 degrees means the far side
  bool values_are_xyz = false; ///< CIE XYZ, stored as linear sRGB
};

/// Lines of numbers as they stand, and where each begins.
struct NumberRows {
  std::vector<double> numbers; ///< row after row
  std::vector<std::string_view> lines;
};
/// Reads to the end; empty lines and those that begin with '#' are left out.
/// @throws Error at a field that is no finite number, or a line of another number of fields
NumberRows read_number_rows(TextLines& lines, int columns);

struct SamplesRead {
  MeasuredSamples samples;
  std::size_t in_surface = 0; ///< left out: a direction in the surface has no f
};
/// @throws Error at the line of an angle out of range
SamplesRead samples_of(const NumberRows& rows, const SampleColumns& columns, const TextLines& lines);

/// "found", "none", "isotropic", "bilateral". @throws Error at `name`, a part of the text
ScatteredBsdf::Symmetry symmetry_named(std::string_view name, const TextLines& lines);
/// The name under which `measured` reads back with the symmetry it has.
std::string_view symmetry_name(const MeasuredBsdf& measured);
/// Names of the columns of values: "f"; "r", "g", "b"; "550nm".
std::vector<std::string> value_names(const Channels& channels);

/// The samples of a measurement for a list of them: without those in the surface, and with a MERL table's
/// once more with wo and wi exchanged where the table states half of its values by reciprocity.
/// @throws Error where there are none
MeasuredSamples samples_to_write(const MeasuredBsdf& measured);
/// theta and azimuth of a direction in degrees; theta above 90 is behind the surface.
std::pair<double, double> angles_deg(const Vec3f& w);

} // namespace nacre
