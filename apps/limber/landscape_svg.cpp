// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "landscape_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace limber::program {
namespace {

struct Point {
  double x = 0, y = 0;
};

struct Color {
  double red = 0, green = 0, blue = 0;  // 0 to 255
};

Color mixed(const Color& a, const Color& b, double share_of_b) {
  const double share_of_a = 1 - share_of_b;
  return {a.red * share_of_a + b.red * share_of_b, a.green * share_of_a + b.green * share_of_b,
          a.blue * share_of_a + b.blue * share_of_b};
}

std::string hex(const Color& c, double brightness) {
  const auto channel = [brightness](double value) {
    return static_cast<int>(std::clamp(value * brightness, 0.0, 255.0));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(c.red), channel(c.green), channel(c.blue));
}

constexpr Color valley{38, 84, 140}, plain{214, 220, 216}, hill{196, 98, 45}, ball_color{236, 196, 72};

/// The viewer stands where x and y are small, looks along (1, 1) and down.
constexpr double slant = 0.62;  // radians below the horizon
const Vec3 toward_viewer{-std::cos(slant) * std::numbers::sqrt2 / 2, -std::cos(slant) * std::numbers::sqrt2 / 2,
                         std::sin(slant)};
const Vec3 light = [] {
  const Vec3 direction{-0.75, 0.1, 0.65};
  return direction * (1 / length(direction));
}();

/// A point of the world, projected into the picture, y downwards, before scaling.
Point projected(const Vec3& p) {
  constexpr double half = std::numbers::sqrt2 / 2;
  return {(p.x - p.y) * half, -((p.x + p.y) * half * std::sin(slant) + p.z * std::cos(slant))};
}

/// A flat piece of surface, ready to be drawn.
struct Patch {
  std::vector<Vec3> corners;
  Color color;
  double nearness = 0;  // larger is in front
};

/// How bright a patch is in the light; both of its sides are the same.
double brightness_of(const std::vector<Vec3>& corners) {
  const Vec3 normal = cross(corners[2] - corners[0], corners.back() - corners[1]);
  const double size = length(normal);
  if (!(size > 0)) return 1;
  const double towards = dot(normal, toward_viewer) < 0 ? -1 : 1;
  return 0.5 + 0.62 * std::max(0.0, towards * dot(normal, light) / size);
}

Patch made_patch(std::vector<Vec3> corners, const Color& color) {
  Vec3 sum;
  for (const Vec3& corner : corners) sum += corner;
  const double nearness = dot(sum, toward_viewer) / static_cast<double>(corners.size());
  return {std::move(corners), color, nearness};
}

Color color_at(double z, double highest) {
  const double t = std::clamp(z / highest, -1.0, 1.0);
  return t < 0 ? mixed(plain, valley, std::sqrt(-t)) : mixed(plain, hill, std::sqrt(t));
}

/// From world to picture: scaled about a world point that appears at the center.
class View {
 public:
  View(double width, double height, double scale, const Vec3& center)
      : width_(width), height_(height), scale_(scale), center_(projected(center)) {}

  Point operator()(const Vec3& p) const {
    const Point s = projected(p);
    return {width_ / 2 + scale_ * (s.x - center_.x), height_ / 2 + scale_ * (s.y - center_.y)};
  }

  bool shows(const Patch& patch) const {
    return std::any_of(patch.corners.begin(), patch.corners.end(), [&](const Vec3& corner) {
      const Point p = (*this)(corner);
      return p.x > -margin_ && p.x < width_ + margin_ && p.y > -margin_ && p.y < height_ + margin_;
    });
  }

  std::string start_tag() const {
    return fmt::format("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {} {}' role='img'>\n", width_, height_);
  }

 private:
  static constexpr double margin_ = 60;
  double width_, height_, scale_;
  Point center_;
};

std::string closed_path(const std::vector<Vec3>& corners, const View& view) {
  const char* move = "M";
  std::string path;
  for (const Vec3& corner : corners) {
    const Point p = view(corner);
    path += fmt::format("{}{:.1f} {:.1f}", move, p.x, p.y);
    move = "L";
  }
  return path + 'z';
}

std::string drawn(std::vector<Patch> patches, const View& view, const char* style) {
  std::sort(patches.begin(), patches.end(), [](const Patch& a, const Patch& b) { return a.nearness < b.nearness; });
  std::string svg = fmt::format("<g class='{}'>\n", style);
  for (const Patch& patch : patches) {
    if (!view.shows(patch)) continue;
    const std::string fill = hex(patch.color, brightness_of(patch.corners));
    svg += fmt::format("<path d='{}' fill='{}' stroke='{}'/>\n", closed_path(patch.corners, view), fill, fill);
  }
  return svg + "</g>\n";
}

double largest_height(const Mesh& sheet) {
  double highest = 1e-9;
  for (const Vec3& p : sheet.positions()) highest = std::max(highest, std::abs(p.z));
  return highest;
}

constexpr std::size_t squares_per_side = 100;  // of the sheet

const Vec3& vertex_at(const Mesh& sheet, std::size_t i, std::size_t j) {
  return sheet.positions()[j * (squares_per_side + 1) + i];
}

/// The sheet for a picture of the whole, for which every other vertex is enough.
std::vector<Patch> coarse_sheet(const Mesh& sheet) {
  constexpr std::size_t stride = 2;
  const double highest = largest_height(sheet);
  std::vector<Patch> patches;
  for (std::size_t j = 0; j < squares_per_side; j += stride) {
    for (std::size_t i = 0; i < squares_per_side; i += stride) {
      std::vector<Vec3> corners = {vertex_at(sheet, i, j), vertex_at(sheet, i + stride, j),
                                   vertex_at(sheet, i + stride, j + stride), vertex_at(sheet, i, j + stride)};
      double height = 0;
      for (const Vec3& corner : corners) height += corner.z / 4;
      patches.push_back(made_patch(std::move(corners), color_at(height, highest)));
    }
  }
  return patches;
}

/// Dots as lines of no length with round ends: the style sheet gives their size in pixels of the page.
std::string dots(const std::vector<Point>& points, const char* size_class) {
  std::string path;
  for (const Point& p : points) path += fmt::format("M{:.1f} {:.1f}h0", p.x, p.y);
  if (path.empty()) return path;
  return fmt::format("<path class='dots {0} under' d='{1}'/><path class='dots {0}' d='{1}'/>\n", size_class, path);
}

std::string trail(const std::vector<DemoFrame>& frames, const View& view) {
  std::string line;
  std::vector<Point> contacts;
  for (const DemoFrame& frame : frames) {
    const Point at = view(frame.ball_center);
    line += fmt::format("{:.1f},{:.1f} ", at.x, at.y);
    if (frame.answer.status == Status::collision) contacts.push_back(at);
  }
  return "<polyline class='trail under' points='" + line + "'/><polyline class='trail' points='" + line + "'/>\n" +
         dots(contacts, "");
}

std::vector<Vec3> corners_of(const Triangle& triangle, const Transform& pose) {
  return {pose(triangle.v0), pose(triangle.v1), pose(triangle.v2)};
}

std::vector<Patch> sheet_triangles(const Mesh& sheet) {
  const double highest = largest_height(sheet);
  std::vector<Patch> patches;
  for (TriangleId t = 0; t < sheet.triangles().size(); ++t) {
    const Triangle triangle = sheet.triangle(t);
    const double height = (triangle.v0.z + triangle.v1.z + triangle.v2.z) / 3;
    patches.push_back(made_patch(corners_of(triangle, {}), color_at(height, highest)));
  }
  return patches;
}

std::string outline(const std::vector<Vec3>& corners, const View& view) {
  return "<path class='outline' d='" + closed_path(corners, view) + "'/>\n";
}

}  // namespace

std::string sheet_svg(const DemoRun& run) {
  constexpr double width = 960, height = 520, scale = 6.4;
  const View view(width, height, scale, {50, 50, 0});
  std::string svg = view.start_tag() + drawn(coarse_sheet(run.sheet), view, "sheet") + trail(run.frames, view);
  const Point at = view(run.ball_pose.translation);
  svg += fmt::format("<circle class='ball' cx='{:.1f}' cy='{:.1f}' r='{:.1f}' fill='{}'/>\n", at.x, at.y, scale,
                     hex(ball_color, 1));
  return svg + "</svg>\n";
}

std::string close_up_svg(const DemoRun& run) {
  constexpr double width = 960, height = 420;
  const Witness& witness = *run.frames.back().answer.witness;
  const double scale = std::min(72.0, height / (4.5 + run.frames.back().answer.upper));
  const View view(width, height, scale, (witness.point_a + run.ball_pose.translation) * 0.5);

  std::vector<Patch> patches = sheet_triangles(run.sheet);
  for (TriangleId t = 0; t < run.ball.triangles().size(); ++t) {
    patches.push_back(made_patch(corners_of(run.ball.triangle(t), run.ball_pose), ball_color));
  }
  std::string svg = view.start_tag() + drawn(std::move(patches), view, "close");
  svg += outline(corners_of(run.sheet.triangle(witness.triangle_a), {}), view);
  svg += outline(corners_of(run.ball.triangle(witness.triangle_b), run.ball_pose), view);
  const Point a = view(witness.point_a), b = view(witness.point_b);
  svg += fmt::format(
      "<path class='witness under' d='M{0:.1f} {1:.1f}L{2:.1f} {3:.1f}'/>"
      "<path class='witness' d='M{0:.1f} {1:.1f}L{2:.1f} {3:.1f}'/>\n",
      a.x, a.y, b.x, b.y);
  return svg + dots({a, b}, "ends") + "</svg>\n";
}

}  // namespace limber::program
