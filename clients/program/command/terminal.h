// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

/// What systems do differently with the streams of a program.
namespace limber::program {

/// Whether what is written to the stream is seen by a person at once.
bool is_terminal(std::FILE* stream);

/// To be called before anything is written: every system then writes the same bytes, and a write fails, instead of a
/// signal ending the program, when the reader is gone or a file as large as it may be.
void prepare_streams();

}  // namespace limber::program
