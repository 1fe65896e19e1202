// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A sheet of springs falls on a body and folds onto itself. It never passes through the body or through itself: after
// every step the program asks for all intersections, and fails if there is one.
//
//   example_08_falling_cloth [seconds [squares [body's mesh file [folder for OBJ files]]]]
//
// Each step asks for all pairs of triangles that are close. They become constraints, and they bound how far each vertex
// may move in the step: triangles that are d apart, and whose vertices move by less than d / 2, cannot meet. These are
// the displacement bounds of Offset Geometric Contact [Chen2025].
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "limber/io.h"
#include "limber/limber.h"
#include "mass_spring.h"
#include "shapes.h"

namespace {

using limber::Vec3;

constexpr int frames_a_second = 60, steps_a_frame = 8, frames_a_line = 15, iterations = 10, most_steps_a_look = 8;
constexpr double side = 2, step_s = 1.0 / (frames_a_second * steps_a_frame);
constexpr double share = 0.45;          // of a gap that either side may use up in a step
constexpr double recovery_speed = 0.2;  // at which surfaces part that are closer than they should be

/// Lengths in proportion to a square of the sheet.
struct Lengths {
  explicit Lengths(double square) : body_gap(0.12 * square), self_gap(0.25 * square) {}
  double body_gap, self_gap;                                      // the constraints keep surfaces so far apart
  double body_margin = 2 * body_gap, self_margin = 2 * self_gap;  // and look so far
};

/// How often the simulation has looked around, and the pairs that it has found.
struct Counts {
  std::size_t looks = 0, body_pairs = 0, self_pairs = 0;
};

/// The body, 1 high, standing on a large floor at z = 0. Meshes have y upward, as the Stanford bunny.
limber::Mesh body_on_floor(const limber::Mesh& mesh) {
  std::vector<Vec3> positions;
  for (const Vec3& p : mesh.positions()) positions.push_back({p.x, -p.z, p.y});
  Vec3 low = positions[0], high = low;
  for (const Vec3& p : positions) low = min(low, p), high = max(high, p);
  const double scale = 1 / (high.z - low.z);
  const Vec3 foot{(low.x + high.x) / 2, (low.y + high.y) / 2, low.z};
  for (Vec3& p : positions) p = scale * (p - foot);
  std::vector<limber::Corners> triangles = mesh.triangles();
  const auto first = static_cast<limber::VertexId>(positions.size());
  for (const Vec3 corner : {Vec3{-4, -4, 0}, Vec3{4, -4, 0}, Vec3{4, 4, 0}, Vec3{-4, 4, 0}})
    positions.push_back(corner);
  triangles.push_back({first, first + 1, first + 2});
  triangles.push_back({first, first + 2, first + 3});
  return limber::Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// The sheet before it falls: nearly upright, above the body, with a slight wave.
std::vector<Vec3> above_the_body(const limber::Mesh& flat) {
  std::vector<Vec3> positions;
  const double tilt = 1.4;
  for (const Vec3& p : flat.positions()) {
    const double x = p.x * std::cos(0.4) - p.y * std::sin(0.4), y = p.x * std::sin(0.4) + p.y * std::cos(0.4);
    positions.push_back({0.1 + x * std::cos(tilt), y, 2.4 + x * std::sin(tilt) + 0.02 * std::sin(5 * y)});
  }
  return positions;
}

/// How close the triangles around each vertex are to each other, apart from what they share. Queries leave neighbors
/// out unless they meet; these are the distances that keep them from meeting.
class Fans {
 public:
  explicit Fans(const limber::Mesh& mesh) : triangles_(mesh.positions().size()), clearances_(triangles_.size(), 0) {
    for (limber::TriangleId t = 0; t < mesh.triangles().size(); ++t) {
      for (const limber::VertexId v : mesh.triangles()[t]) triangles_[v].push_back(t);
    }
  }

  /// Lowers `reach` where neighbors are close. A clearance shrinks by at most twice the motion relative to the fan's
  /// center, so it is measured anew only where it may have become less than `margin`.
  void bound(const limber::Mesh& mesh, const mass_spring::Sheet& sheet, double margin, std::vector<double>& reach) {
    for (limber::VertexId v = 0; v < triangles_.size(); ++v) {
      double moved = 0;
      for (const limber::TriangleId t : triangles_[v]) {
        for (const limber::VertexId u : mesh.triangles()[t]) {
          moved = std::max(moved, length_sq(sheet.motion(u) - sheet.motion(v)));
        }
      }
      clearances_[v] -= 2 * std::sqrt(moved);
      if (clearances_[v] < margin) clearances_[v] = measured(mesh, v);
      if (clearances_[v] >= margin) continue;
      for (const limber::TriangleId t : triangles_[v]) {
        for (const limber::VertexId u : mesh.triangles()[t]) reach[u] = std::min(reach[u], share * clearances_[v]);
      }
    }
  }

 private:
  double measured(const limber::Mesh& mesh, limber::VertexId v) const {
    double clearance = 1e9;
    for (const limber::TriangleId s : triangles_[v]) {
      for (const limber::TriangleId t : triangles_[v]) {
        if (s != t) clearance = std::min(clearance, from_far_side(mesh, s, t));
      }
    }
    return clearance;
  }

  /// From the part of s that has no corner of t to t: an edge, or a corner and the edges that cross at a fold.
  static double from_far_side(const limber::Mesh& mesh, limber::TriangleId s, limber::TriangleId t) {
    const std::vector<Vec3>& p = mesh.positions();
    std::array<limber::VertexId, 3> own{}, shared{};
    std::size_t own_count = 0, shared_count = 0;
    const limber::Corners& other = mesh.triangles()[t];
    for (const limber::VertexId u : mesh.triangles()[s]) {
      const bool is_shared = std::find(other.begin(), other.end(), u) != other.end();
      (is_shared ? shared[shared_count++] : own[own_count++]) = u;
    }
    if (own_count == 2) return closest_points({p[own[0]], p[own[1]], p[own[1]]}, mesh.triangle(t)).distance;
    limber::VertexId far = other[0];
    for (const limber::VertexId u : other) far = u == shared[0] || u == shared[1] ? far : u;
    return std::min({closest_points(p[own[0]], mesh.triangle(t)).distance,
                     closest_points(limber::Segment{p[own[0]], p[shared[0]]}, {p[far], p[shared[1]]}).distance,
                     closest_points(limber::Segment{p[own[0]], p[shared[1]]}, {p[far], p[shared[0]]}).distance});
  }

  std::vector<std::vector<limber::TriangleId>> triangles_;  // around each vertex
  std::vector<double> clearances_;                          // lower bounds
};

/// The constraint of a contact, with the sheet's triangle first. The body, as the second, does not move.
mass_spring::Constraint constraint_of(const limber::Contact& contact, const limber::Mesh& sheet, bool is_of_sheet_only,
                                      double wanted) {
  mass_spring::Constraint c{.normal = contact.normal, .gap = contact.distance};
  c.wanted = std::min(wanted, contact.distance + recovery_speed * step_s);
  const auto add = [&](limber::TriangleId triangle, const Vec3& point, double sign, std::size_t first) {
    const std::array<double, 3> weights = mass_spring::barycentric(sheet.triangle(triangle), point);
    for (std::size_t i = 0; i < 3; ++i) {
      c.vertices[first + i] = sheet.triangles()[triangle][i];
      c.weights[first + i] = sign * weights[i];
    }
  };
  add(contact.triangle_a, contact.point_a, -1, 0);
  if (is_of_sheet_only) add(contact.triangle_b, contact.point_b, 1, 3);
  return c;
}

void write_obj(const std::filesystem::path& path, const limber::Mesh& mesh) {
  std::ofstream file(path);
  file.precision(9);
  for (const Vec3& p : mesh.positions()) file << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const limber::Corners& c : mesh.triangles()) {
    file << "f " << c[0] + 1 << ' ' << c[1] + 1 << ' ' << c[2] + 1 << '\n';
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

/// Sheet and body, and the steps of time.
class Simulation {
 public:
  Simulation(const limber::Mesh& body, std::uint32_t squares)
      : Simulation(body, squares, shapes::sheet(squares, side)) {}

  const limber::Model& cloth() const { return cloth_; }
  const limber::Model& body() const { return body_; }

  /// Returns how many pairs of triangles intersect afterwards.
  std::size_t step(Counts& counts) {
    if (at_limit_ > sheet_.positions().size() / 100 || age_ == most_steps_a_look) look_around(counts);
    at_limit_ = sheet_.step(step_s, iterations);
    ++age_;
    cloth_.move_all(sheet_.positions()).value();
    cloth_.commit();
    return meeting();
  }

  /// How many pairs of triangles intersect.
  std::size_t meeting() const {
    return limber::self_intersections(cloth_, {}).count + limber::intersections({cloth_}, {body_}, {}).count;
  }

 private:
  /// Finds all that is close, for constraints, and for how far each vertex may move until the next look.
  void look_around(Counts& counts) {
    const limber::Mesh& mesh = cloth_.mesh();
    std::vector<double> reach(mesh.positions().size(),
                              std::min(share * lengths_.self_margin, 2 * share * lengths_.body_margin));
    std::vector<mass_spring::Constraint> constraints;
    const auto bound = [&](limber::TriangleId triangle, double most) {
      for (const limber::VertexId v : mesh.triangles()[triangle]) reach[v] = std::min(reach[v], most);
    };
    const auto take_body = [&](const limber::Contact& contact) {
      bound(contact.triangle_a, 2 * share * contact.distance);  // the body stands still
      constraints.push_back(constraint_of(contact, mesh, false, lengths_.body_gap));
      return true;
    };
    const auto take_self = [&](const limber::Contact& contact) {
      bound(contact.triangle_a, share * contact.distance);
      bound(contact.triangle_b, share * contact.distance);
      constraints.push_back(constraint_of(contact, mesh, true, lengths_.self_gap));
      return true;
    };
    counts.body_pairs += limber::visit_contacts({cloth_}, {body_}, lengths_.body_margin, take_body).count;
    counts.self_pairs += limber::visit_self_contacts(cloth_, lengths_.self_margin, take_self).count;
    fans_.bound(mesh, sheet_, lengths_.self_margin, reach);
    sheet_.look_around(std::move(constraints), std::move(reach));
    ++counts.looks;
    age_ = 0;
  }

  Simulation(const limber::Mesh& body, std::uint32_t squares, const limber::Mesh& flat)
      : lengths_(side / squares),
        sheet_(flat.positions(), above_the_body(flat), squares),
        body_(body_on_floor(body)),
        cloth_(limber::Mesh::create(sheet_.positions(), flat.triangles()).value()),
        fans_(flat) {}

  Lengths lengths_;
  mass_spring::Sheet sheet_;
  limber::Model body_, cloth_;
  Fans fans_;
  int age_ = most_steps_a_look;  // steps since the last look around
  std::size_t at_limit_ = 0;     // vertices that will have gone as far as they may
};

/// Not a number, where the whole text is none.
double number(const char* text) {
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  return end != text && *end == 0 ? value : std::nan("");
}

}  // namespace

int main(int argc, char** argv) try {
  const double seconds = argc > 1 ? number(argv[1]) : 10;
  const double squares = argc > 2 ? number(argv[2]) : 71;
  if (!(seconds > 0 && seconds <= 3600 && squares >= 2 && squares <= 1000)) {
    throw std::runtime_error("seconds are above 0 and at most 3600, squares from 2 to 1000");
  }
  const std::filesystem::path folder = argc > 4 ? argv[4] : "";
  Simulation simulation(argc > 3 ? limber::load_mesh(argv[3]).value() : shapes::ball(48),
                        static_cast<std::uint32_t>(squares));
  if (!folder.empty()) write_obj(folder / "body.obj", simulation.body().mesh());

  const int frames = static_cast<int>(std::ceil(seconds * frames_a_second));
  std::size_t meeting_steps = 0;
  std::printf("frame  looks    body    self   ms a frame    pairs are those of a look\n");
  for (int first = 0; first < frames; first += frames_a_line) {
    Counts counts;
    const auto start = std::chrono::steady_clock::now();
    const int last = std::min(first + frames_a_line, frames), count = last - first;
    for (int i = 0; i < count * steps_a_frame; ++i) meeting_steps += simulation.step(counts) > 0 ? 1 : 0;
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    const std::size_t looks = std::max<std::size_t>(counts.looks, 1);
    std::printf("%5d %6zu %7zu %7zu %12.2f\n", last, counts.looks, counts.body_pairs / looks, counts.self_pairs / looks,
                took.count() / count);
    if (!folder.empty()) write_obj(folder / ("cloth_" + std::to_string(last) + ".obj"), simulation.cloth().mesh());
  }
  const std::size_t meeting = simulation.meeting();
  std::printf("at the end %zu pairs intersect; %zu of %d steps had any\n", meeting, meeting_steps,
              frames * steps_a_frame);
  return meeting + meeting_steps > 0 ? 1 : 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
