#pragma once
// What every page of a report is made of: one look, no script from elsewhere, no font, no network.

#include "core/image.h"

#include <array>
#include <functional>
#include <string>

namespace nacre {

/// A whole HTML file. @param title  plain text; @param main  HTML
std::string html_page(const std::string& title, const std::string& main);

/// A number for a person to read: a true minus sign, a dash for NaN.
std::string html_number(double value, int digits = 4);
/// "#rrggbb" of an sRGB code.
std::string html_colour(const std::array<float, 3>& code);
std::string html_image(const Image& picture, const std::string& description);
/// @param content, caption  HTML
std::string html_figure(const std::string& content, const std::string& caption);
/// One of the large figures at the head of a page. @param value, meaning  HTML
std::string html_fact(const std::string& value, const std::string& meaning);
/// A bar with the colours of [lo, hi].
std::string html_ramp(const std::function<std::array<float, 3>(double)>& colour, double lo, double hi);
/// Two pictures of one size, the second uncovered by dragging.
std::string html_wipe(const Image& first, const Image& second, const std::string& first_name,
                      const std::string& second_name);

} // namespace nacre
