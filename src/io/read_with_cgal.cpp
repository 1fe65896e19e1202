// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <locale>
#include <sstream>
#include <utility>

#include "io/prepare.h"
#include "io/read_soup.h"
#include "io/text_scan.h"

namespace limber::io {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Polygons = std::vector<std::vector<std::int64_t>>;  // signed, so that a negative index shows

template <typename Reader>
Result<Soup> read(std::string text, const Reader& reader) {
  std::vector<Point> points;
  Polygons polygons;
  std::istringstream in(std::move(text));
  in.imbue(std::locale::classic());
  if (!reader(in, points, polygons)) return malformed("cannot be read to its end");

  if (points.size() >= no_id) return Error{ErrorCode::too_large, "has more vertices than ids can count", {}};
  Soup soup;
  soup.positions.reserve(points.size());
  for (const Point& point : points) soup.positions.push_back({point.x(), point.y(), point.z()});
  for (const auto& polygon : polygons) {
    if (Result<void> added = add_face(soup.faces, polygon, 0, points.size()); !added) return added.error();
  }
  return soup;
}

/// CGAL reads numbers of OBJ and OFF files with whatever decimal point the global locale has. Nothing but numbers holds
/// a point in prepared files.
std::string localised(std::string text) {
  const char point = std::use_facet<std::numpunct<char>>(std::locale()).decimal_point();
  if (point != '.') std::replace(text.begin(), text.end(), '.', point);
  return text;
}

Result<Soup> read_prepared_obj(Result<std::string> text) {
  if (!text) return text.error();
  // CGAL takes a file without vertices or without faces for unreadable.
  if (text->find('v') == text->npos || text->find('f') == text->npos) {
    return Error{ErrorCode::empty_mesh, "has no face of three corners", {}};
  }
  return read(localised(std::move(*text)), [](std::istream& in, auto& points, auto& polygons) {
    return CGAL::IO::read_OBJ(in, points, polygons, CGAL::parameters::verbose(false));
  });
}

}  // namespace

Result<Soup> read_obj(std::string_view file) { return read_prepared_obj(prepare_obj(file)); }

Result<Soup> read_stl_text(std::string_view file) {
  Result<std::string> text = prepare_stl_text(file);
  if (text && text->empty()) return Soup();
  return read_prepared_obj(std::move(text));
}

Result<Soup> read_ply(std::string_view file) {
  Result<std::string> text = prepare_ply(file);
  if (!text) return text.error();
  return read(std::move(*text), [](std::istream& in, auto& points, auto& polygons) {
    return CGAL::IO::read_PLY(in, points, polygons, CGAL::parameters::verbose(false));
  });
}

Result<Soup> read_off(std::string_view file) {
  Result<std::string> text = prepare_off(file);
  if (!text) return text.error();
  return read(localised(std::move(*text)), [](std::istream& in, auto& points, auto& polygons) {
    return CGAL::IO::read_OFF(in, points, polygons, CGAL::parameters::verbose(false));
  });
}

}  // namespace limber::io
