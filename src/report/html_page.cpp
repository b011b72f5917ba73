#include "report/html_page.h"

#include "report/pictures.h"
#include "report/svg_plot.h"

#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

// Colours of the page and of the plots in it; the plots' own attributes are those of the light theme.
constexpr const char* style = R"(
:root{color-scheme:light dark;--page:#fbfbfa;--card:#ffffff;--ink:#1d1f21;--soft:#5d6166;--line:#dcdee0;
--good:#00704f;--bad:#b54a00;--accent:#0062a3}
@media(prefers-color-scheme:dark){:root{--page:#15171a;--card:#1d2024;--ink:#e6e7e8;--soft:#a0a5ab;
--line:#363b41;--good:#3ccf9f;--bad:#ff9a52;--accent:#6cb8f0}
.plot-background{fill:#1d2024}.plot-text{fill:#dfe1e3}.plot-grid{stroke:#343940}.plot-axis{stroke:#7a8087}
.series-0{--c:#4aa8e0}.series-1{--c:#ff8a3d}.series-2{--c:#2cc295}.series-3{--c:#e39ac4}.series-4{--c:#f0b429}
.series-5{--c:#8ccdf5}.series-6{--c:#e6e7e8}
g[class^=series]{fill:var(--c)}path[class^=series]{stroke:var(--c)}}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
main{max-width:1240px;margin:0 auto;padding:32px 24px 64px}
h1{font-size:30px;line-height:1.2;margin:0 0 4px}h2{font-size:21px;margin:44px 0 8px}
h3{font-size:16px;margin:20px 0 6px}
p{max-width:80ch;margin:8px 0}.soft{color:var(--soft)}
code{font:13.5px ui-monospace,monospace;overflow-wrap:anywhere}
.grid{display:grid;gap:16px;grid-template-columns:repeat(auto-fit,minmax(min(100%,370px),1fr))}
.plots{display:grid;gap:16px;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr))}
figure{margin:0;background:var(--card);border:1px solid var(--line);border-radius:8px;overflow:hidden}
figure img{display:block;width:100%;height:auto}figure svg.plot{display:block;width:100%;height:auto}
figcaption{padding:8px 12px;font-size:14px;color:var(--soft)}figcaption b{color:var(--ink)}
.facts{display:grid;gap:12px;grid-template-columns:repeat(auto-fit,minmax(170px,1fr));margin:20px 0}
.fact{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px 14px}
.fact b{display:block;font-size:22px;font-variant-numeric:tabular-nums}.fact>span{font-size:13.5px;color:var(--soft)}
.scroll{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:8px}
table{border-collapse:collapse;width:100%;font-size:14.5px;font-variant-numeric:tabular-nums}
th,td{text-align:left;padding:6px 12px;border-bottom:1px solid var(--line);vertical-align:top}
tr:last-child td{border-bottom:0}th{font-weight:600;color:var(--soft);font-size:13px}
.key,.errors td:first-child{white-space:nowrap}
td{overflow-wrap:anywhere}td.n,.step,td:first-child{overflow-wrap:normal}.step{white-space:nowrap}
td.n,th.n{text-align:right;white-space:nowrap}
.holds{color:var(--good);white-space:nowrap}.violated{color:var(--bad);font-weight:600;white-space:nowrap}
.bar{display:inline-block;height:9px;border-radius:3px;background:var(--accent);vertical-align:middle}
.ramp{display:inline-block;width:120px;height:10px;border-radius:3px;vertical-align:middle;margin:0 6px}
.wipe{position:relative;--x:50%}.wipe .over{position:absolute;inset:0;clip-path:inset(0 0 0 var(--x))}
.wipe::after{content:'';position:absolute;top:0;bottom:0;left:var(--x);width:2px;margin-left:-1px;
background:#fff;box-shadow:0 0 3px #000}
.wipe input{position:absolute;inset:0;width:100%;height:100%;opacity:0;cursor:ew-resize;margin:0;z-index:1}
@media print{body{background:#fff}figure,.scroll,.fact{break-inside:avoid}}
)";

} // namespace

std::string html_page(const std::string& title, const std::string& main) {
  return "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8>\n<meta name=viewport "
         "content='width=device-width,initial-scale=1'>\n<title>" +
         escape_xml(title) + "</title>\n<style>" + style + "</style></head><body><main>\n" + main +
         "</main></body></html>\n";
}

std::string html_number(double v, int digits) {
  if (std::isnan(v)) return "–";
  if (std::isinf(v)) return v > 0 ? "∞" : "−∞";
  std::string text = fmt::format("{:.{}g}", v, digits);
  // 1.2e-05 as 1.2·10⁻⁵ would be nicer to read and worse to copy; only the sign is made typographic.
  if (text[0] == '-') text.replace(0, 1, "−");
  return text;
}

std::string html_colour(const std::array<float, 3>& code) {
  const auto byte = [](float v) { return static_cast<int>(std::lround(255 * v)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(code[0]), byte(code[1]), byte(code[2]));
}

std::string html_ramp(const std::function<std::array<float, 3>(double)>& colour, double lo, double hi) {
  std::string stops;
  for (int i = 0; i <= 8; ++i)
    stops.append(1, ',').append(html_colour(colour(lo + (hi - lo) * i / 8)));
  return fmt::format("<span class=ramp style='background:linear-gradient(90deg{})'></span>", stops);
}

std::string html_image(const Image& picture, const std::string& description) {
  return fmt::format("<img width='{}' height='{}' alt='{}' src='{}'>", picture.width, picture.height,
                     escape_xml(description), png_data_url(picture));
}

std::string html_figure(const std::string& content, const std::string& caption) {
  return "<figure>" + content + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string html_fact(const std::string& value, const std::string& meaning) {
  return "<div class=fact><b>" + value + "</b><span>" + meaning + "</span></div>\n";
}

std::string html_wipe(const Image& first, const Image& second, const std::string& first_name,
                      const std::string& second_name) {
  return "<div class=wipe>" + html_image(first, first_name) +
         fmt::format("<img class=over alt='{}' src='{}'>", escape_xml(second_name), png_data_url(second)) +
         fmt::format("<input type=range min=0 max=100 step=0.2 value=50 aria-label='Where the {} begins' "
                     "oninput=\"this.parentNode.style.setProperty('--x',this.value+'%')\"></div>",
                     escape_xml(second_name));
}

} // namespace nacre
