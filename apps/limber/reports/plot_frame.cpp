// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/plot_frame.h"

#include <fmt/format.h>

namespace limber::program {

std::string plot_svg(const std::vector<Tick>& horizontal, const std::vector<Tick>& vertical, const std::string& name,
                     const std::string& curves) {
  std::string svg = "<svg xmlns='http://www.w3.org/2000/svg' class='chart' role='img'>\n";
  for (const Tick& tick : vertical) {
    const double y = plot_height * (1 - tick.share);
    svg += fmt::format("<line class='grid' x2='100%' y1='{0:.1f}' y2='{0:.1f}'/>", y);
    svg += fmt::format("<text class='value' x='-8' y='{:.1f}'>{:.12g}</text>\n", y + 4, tick.value);
  }
  for (const Tick& tick : horizontal) {
    const double percent = 100 * tick.share;
    svg += fmt::format("<line class='axis' x1='{0:.2f}%' x2='{0:.2f}%' y1='{1}' y2='{2}'/>", percent, plot_height,
                       plot_height + 5);
    svg +=
        fmt::format("<text class='frame' x='{:.2f}%' y='{}'>{:.12g}</text>\n", percent, plot_height + 20, tick.value);
  }
  svg += fmt::format("<line class='axis' x2='100%' y1='{0}' y2='{0}'/>\n", plot_height);
  svg += fmt::format("<text class='name' x='100%' y='{}'>{}</text>\n", plot_height + 38, name);
  // The nested picture alone is stretched; lines keep their width by the style sheet.
  svg += fmt::format("<svg viewBox='0 0 {0} {1}' preserveAspectRatio='none' width='100%' height='{1}'>\n", plot_width,
                     plot_height);
  return svg + curves + "</svg>\n</svg>\n";
}

std::string legend_entry(const std::string& symbol, const std::string& label) {
  return "<span><svg class='symbol' width='22' height='10'>" + symbol + "</svg>" + label + "</span>\n";
}

}  // namespace limber::program
