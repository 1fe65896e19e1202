// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Marks what a shared library shows to programs; all other names stay inside. A static library shows nothing, so that
/// a shared library of somebody else's that contains limber does not show limber's names.
#if defined(__GNUC__) && !defined(LIMBER_STATIC)
#define LIMBER_API __attribute__((visibility("default")))
#else
#define LIMBER_API
#endif
