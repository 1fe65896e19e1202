// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "command/output.h"
#include "formats/contact_list.h"

namespace CLI {
class App;
}

namespace limber::program {

/// What the verbs about pairs of triangles share: which pairs are asked for, and where they are written.
struct ContactArguments {
  std::optional<double> margin;
  bool intersections = false;
  std::optional<std::uint64_t> closest;
  std::string csv;  // empty: no file
  std::optional<std::uint64_t> limit;
  bool json = false;
  bool exit_code = false;
};

/// `--margin`, with what it means.
void add_margin(CLI::App& command, std::optional<double>& target, const std::string& description);

/// `--margin`, `--intersections`, `--closest`, `--csv`, `--limit`, `--json`, and `--exit-code` with what it tells.
void add_contact_arguments(CLI::App& command, ContactArguments& arguments, const std::string& told);

/// To be called once everything is parsed: at most one of the first three options may be given, and standard output is
/// for one answer. Returns whether there is such a question.
bool check_contact_arguments(const CLI::App& command);

/// The help about rows and columns.
std::string contact_rows_help();

/// Writes what a verb has found where its arguments say.
class ContactOutput {
 public:
  /// Opens the CSV file, if there is one.
  ///
  /// Errors   BadInput where it cannot be written, or is one of the `inputs`.
  ContactOutput(const ContactArguments& arguments, const Names& inputs);

  /// How many pairs are written at most.
  std::size_t room() const;

  /// Writes the file, and an answer to standard output: one object, made by `append` around the pairs; or what `lines`
  /// writes, and a table. Errors: OutputFailed.
  void write(const FoundContacts& found, const std::function<Json()>& json, const std::function<void()>& lines);

 private:
  std::size_t table_rows() const;
  void write_csv(const FoundContacts& found);

  ContactArguments arguments_;
  std::optional<OutputFile> csv_;
};

}  // namespace limber::program
