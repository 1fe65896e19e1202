// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptics/percentiles.h"

/// Histograms as inline SVG that fills the width of the page, both axes logarithmic; drawn like the charts of
/// chart_svg.h, with the same classes.
namespace limber::program {

struct HistogramCurve {
  std::string label;
  std::string style;  ///< class of the line: "first" or "second"
  LogHistogram histogram;
};

struct HistogramChart {
  std::string unit;  ///< of the values, along the horizontal axis
  std::vector<HistogramCurve> curves;
  std::optional<double> marked_value;  ///< a line from top to bottom
  std::string mark_label;
};

/// The line above a chart: the names of everything drawn.
std::string histogram_legend(const HistogramChart& chart);

/// Pre: there is a curve, and each has a value. The marked value is positive.
std::string histogram_svg(const HistogramChart& chart);

}  // namespace limber::program
