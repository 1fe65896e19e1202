// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

/// What the charts of a page have in common: axes, the area that curves are drawn in, entries of legends.
namespace limber::program {

// Where curves are drawn: pixels from the top, and from the left before it is stretched to the width of the chart.
constexpr double plot_height = 190;
constexpr double plot_width = 1000;

/// A number beside an axis. `share` of the axis lies before it: from the left, or from below.
struct Tick {
  double share;
  double value;
};

/// A chart: `curves`, drawn inside plot_width and plot_height, with axes; `name` is that of the horizontal one.
std::string plot_svg(const std::vector<Tick>& horizontal, const std::vector<Tick>& vertical, const std::string& name,
                     const std::string& curves);

/// A name in a legend, and its symbol: content of an SVG of 22 by 10 pixels.
std::string legend_entry(const std::string& symbol, const std::string& label);

}  // namespace limber::program
