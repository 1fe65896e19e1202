// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <vector>

#include "limber/base.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/math.h"
#include "limber/mesh.h"
#include "limber/model.h"
#include "limber/path.h"

/// What the folder limber3d, the JavaScript half of the package, calls and reads. Whatever is declared here is private
/// to the two: the public interface is the one of JavaScript.
///
/// Numbers go as arguments; poses, arrays and results through memory. Functions that can fail return whether they have
/// succeeded; if not, `error` says why.
namespace limber::web {

/// What a query may be about: a model or a shape. JavaScript knows it by its address.
struct BodyOwner {
  virtual ~BodyOwner() = default;
  virtual Body body() const = 0;
};

/// A model. BodyOwner comes first, so that its address is that of the whole.
struct OwnedModel : BodyOwner, Model {
  using Model::Model;
  Body body() const override { return static_cast<const Model&>(*this); }
};

/// Makes a function callable from JavaScript.
#define LIMBER_EXPORT(name) extern "C" __attribute__((export_name(#name)))

/// How a pose is written in Exchange::poses.
enum class PoseForm : std::uint32_t {
  identity,    ///< not at all
  matrix,      ///< 16 numbers, by columns
  quaternion,  ///< x, y, z, w, then the translation
  rotation,    ///< 9 numbers, by columns, then the translation
};

/// Where JavaScript writes poses, and reads results.
struct Exchange {
  double poses[2][16];
  double numbers[64];
  std::uint32_t words[32];
};
extern Exchange exchange;

/// The pose in Exchange::poses[which].
///
/// Throws   BadResult, which begins with the name of the argument.
Transform pose_from(PoseForm form, std::size_t which, const char* name);

/// Memory for arrays on their way from JavaScript, until the next call of reserve_input().
std::byte* input();

/// Coordinates at the beginning of input().
PositionsView positions_from(std::size_t count, bool is_float32);
std::vector<Vec3> points_from(std::size_t count, bool is_float32);

/// PathOptions::distance_error, which need not be given.
inline std::optional<double> error_from(bool is_given, double error) {
  return is_given ? std::optional(error) : std::nullopt;
}

inline std::uint32_t address_of(const void* p) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(p));
}

inline void put(double*& to, const Vec3& v) { *to++ = v.x, *to++ = v.y, *to++ = v.z; }

/// Writes where a result begins, and how many bytes it has, to Exchange::words[0] and [1].
void give_bytes(const void* first, std::size_t bytes);

/// A mesh in input(): coordinates, then the ids of triangles.
///
/// Throws   BadResult, as Mesh::create().
Mesh mesh_from(std::size_t vertex_count, bool is_float32, std::size_t triangle_count);
/// Writes where vertices and triangles of a mesh are, and how many there are, to the first four of Exchange::words.
void give_mesh(const Mesh& mesh);

/// Thrown when a filter of JavaScript has thrown: ends the query.
struct FilterHasThrown {};

/// Asks the filter of the query under way whether a pair counts: of triangles, or of objects.
///
/// Throws   FilterHasThrown.
bool ask_filter(std::uint32_t a, std::uint32_t b);

/// Writes the error for what is being thrown. Pre: called by an exception handler.
void keep_current_error();

/// Runs `body`; returns whether it has returned.
template <typename Body>
bool guarded(const Body& body) {
  try {
    body();
    return true;
  } catch (const std::exception&) {
    keep_current_error();
  } catch (const FilterHasThrown&) {
    keep_current_error();
  }
  return false;
}

/// The budget that JavaScript asks for: a deadline in milliseconds of performance.now(), and a number of steps. Both
/// are infinite where there is none.
QueryBudget budget_from(double deadline_ms, double max_steps);

/// Writes a result: to Exchange::numbers the bounds of the distance, the two points and the statistics; to words the
/// two triangles, status or answer, and what has stopped the query. Without a witness the triangles are no_id.
void give(const DistanceResult& result);
void give(const PathImpact& impact);
void give(const CollideResult& result);
/// Writes a result that has no bounds: all of the above but these.
void give(const std::optional<Witness>& witness, const QueryStats& stats, std::uint32_t status, StoppedBy stopped_by);

/// Writes statistics to Exchange::numbers[first] and the next.
void give_stats(const QueryStats& stats, std::size_t first);

/// Writes how many there are of what give_bytes() has told of, to Exchange::words[2], whether they are all, to [3], and
/// statistics to Exchange::numbers[0] and [1].
void give_count(std::size_t count, bool is_complete, const QueryStats& stats);

/// Writes contacts, and tells of them as give_count() does. One column after the other: distances, depths, points of a,
/// points of b, normals, weights of a, weights of b; then, in 32 bits, triangles of a and of b; then, in 8 bits, kind
/// and index of each feature of a, of each feature of b, and the normals' sides.
void give_contacts(std::span<const Contact> contacts, const PairCount& count);

/// OrientedFaces by its number; -1 leaves the choice to the library.
std::optional<OrientedFaces> oriented_faces_from(int number);

/// Memory for the columns of many answers.
class Columns {
 public:
  /// Begins anew, with room for that many numbers, then that many ids, then that many bytes; tells where they are.
  void begin(std::size_t number_count, std::size_t id_count, std::size_t byte_count) {
    const std::size_t bytes = number_count * sizeof(double) + id_count * sizeof(std::uint32_t) + byte_count;
    memory_.resize((bytes + sizeof(double) - 1) / sizeof(double));
    number = memory_.data();
    id = reinterpret_cast<std::uint32_t*>(number + number_count);
    byte = reinterpret_cast<std::uint8_t*>(id + id_count);
    give_bytes(memory_.data(), bytes);
  }

  double* number = nullptr;  ///< where the next number goes
  std::uint32_t* id = nullptr;
  std::uint8_t* byte = nullptr;

 private:
  std::vector<double> memory_;  // of double for the sake of alignment
};

/// Collects pairs, contacts or impacts until there are `most`; one more tells that they are not all.
template <typename T>
auto collector(std::vector<T>& found, double most) {
  found.clear();
  return [&found, most](const T& one) {
    if (static_cast<double>(found.size()) >= most) return false;
    found.push_back(one);
    return true;
  };
}

}  // namespace limber::web
