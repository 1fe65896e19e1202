// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "limber/math.h"

/// Files of comma-separated values, as spreadsheets and Python write them: poses, points, pairs of models, parts.
///
/// Blank lines and those that start with # are skipped, a byte order mark and carriage returns too. Fields are trimmed.
/// A field may stand in double quotes, with "" for a quote; it cannot span lines. Numbers have a decimal point. A first
/// row of names alone is a header: it names the columns, in any order, and others may stand between them, unless the
/// format is complete.
///
/// Errors   BadInput of whatever reads a file, naming it and, where there are some, line and column.
namespace limber::program {

struct CsvFormat {
  const char* entry;                            ///< what a row is: "pose"
  std::vector<std::string> columns;             ///< that are known
  std::size_t required_count = columns.size();  ///< so many of them must be there
  bool has_header = false;                      ///< whether there must be one; without it a row has numbers alone
  std::string hint = {};                        ///< added where a column is missing, or unknown
  bool is_complete = false;                     ///< whether other columns are errors
};

/// A row: the fields under the known columns, empty where there is no such column, and its line, counted from 1.
using CsvTaker = std::function<void(const std::vector<std::string>& fields, std::size_t line)>;

/// Reads a file row by row; one line of it is in memory at a time. What is wrong with a row, `take` throws as BadInput.
///
/// Errors   BadInput where the file has no row, a known column comes twice or is misspelt, a complete format has
///          another, or a row is too short or too long. Pipes and devices, which might never end, are refused, and so
///          are files of more than 2^28 bytes.
void read_csv(const std::string& path, const CsvFormat& format, const CsvTaker& take);

/// A translation in the mesh's length unit and a quaternion, which is normalised.
inline constexpr const char* pose_format = "tx,ty,tz,qw,qx,qy,qz";

/// Errors   One line without the place; the code says little.
Result<Transform> parsed_pose(std::string_view text);

/// The poses of a file, one per row.
std::vector<Transform> read_poses(const std::string& path);

/// The points of a file, one per row, whose columns are x, y and z. Numbers that are not finite or above
/// `max_coordinate` in size are refused.
std::vector<Vec3> read_points(const std::string& path);

/// A model in a row of a file.
struct ModelRow {
  std::string column;    ///< that names it
  std::string model;     ///< as on the command line
  std::string name;      ///< of a part; empty where the file has none
  Transform pose;        ///< world_from_model
  std::size_t line = 0;  ///< where it stands in the file, counted from 1
};

/// Rows with a header, which have a model for each suffix: with "_a" and "_b" those of pairs, two entries for each row;
/// with "" those of parts. Columns are model_a and, where they are wanted, pose_a_tx to pose_a_qz, and so on; parts may
/// have a name. Numbers that are left out are those of the identity, but a quaternion is whole.
std::vector<ModelRow> read_models(const std::string& path, const std::vector<std::string>& suffixes);

}  // namespace limber::program
