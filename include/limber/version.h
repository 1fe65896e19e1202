// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The version of these headers. docs/guide/install.md, "Versions", says what a version may change.
#define LIMBER_VERSION_MAJOR 1
#define LIMBER_VERSION_MINOR 0
#define LIMBER_VERSION_PATCH 0

/// Whether these headers are of a version or a later one, for #if.
#define LIMBER_VERSION_AT_LEAST(major, minor, patch) \
  (LIMBER_VERSION_MAJOR > (major) ||                 \
   (LIMBER_VERSION_MAJOR == (major) &&               \
    (LIMBER_VERSION_MINOR > (minor) || (LIMBER_VERSION_MINOR == (minor) && LIMBER_VERSION_PATCH >= (patch)))))
