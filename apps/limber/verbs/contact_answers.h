// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "command/output.h"
#include "formats/contact_list.h"

/// Pairs of triangles as several verbs write them: in JSON, as lines of text, and as cells of CSV.
namespace limber::program {

/// "vertex 0", "edge 2", "face".
std::string to_text(Feature feature);
std::string to_text(NormalSide side);

/// One object.
Json to_json(const FoundContact& contact, ContactDetail detail);

/// The cells under `contact_columns()`.
std::string csv_cells(const FoundContact& contact, ContactDetail detail);
std::string contact_columns(ContactDetail detail);

/// `count`, `intersecting` and `pairs`.
void append_contacts(Json& json, const FoundContacts& found);

/// How many pairs there are.
void write_count_line(const FoundContacts& found);
/// At most `row_count` of the pairs, below a blank line and names of columns. Nothing where there is no row.
void write_table(const FoundContacts& found, std::size_t row_count);

}  // namespace limber::program
