#pragma once
// What the HTML pages share: one look, and pieces that need nothing from elsewhere.

#include "core/image.h"
#include "validate/validate.h"

#include <array>
#include <fmt/format.h>
#include <string>

namespace nacre {

/// From the document's type to the opened <main>; `title` is plain text.
std::string page_head(const std::string& title);
std::string page_foot();

/// A number as text of `digits` significant digits, with a true minus sign; "–" if it is not a number.
std::string number(double v, int digits = 4);
/// "#rrggbb" of an sRGB code.
std::string hex(const std::array<float, 3>& code);
/// A strip of the colours `colour` gives from `lo` to `hi`.
template <class Colour>
std::string ramp(Colour colour, double lo, double hi) {
  std::string stops;
  for (int i = 0; i <= 8; ++i)
    stops.append(1, ',').append(hex(colour(lo + (hi - lo) * i / 8)));
  return fmt::format("<span class=ramp style='background:linear-gradient(90deg{})'></span>", stops);
}
/// A picture inside the page; `description` is plain text, the other arguments are HTML.
std::string image(const Image& picture, const std::string& description);
std::string figure(const std::string& content, const std::string& caption);
std::string fact(const std::string& value, const std::string& meaning);

const char* verdict_class(Verdict verdict);
const char* verdict_text(Verdict verdict);
/// Of all laws together: holds, or how many are violated.
std::string verdict_fact(const ValidationReport& report);

} // namespace nacre
