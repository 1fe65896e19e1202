// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// What the fuzz targets try beyond ordinary use. Each constant stands for a promise that the library may not make yet;
/// `false` leaves the case out.
namespace limber::fuzz {

/// Coordinates of models other than 0 and those from 2^-60 to 8 times the scale of the scene, and scales below 2^-149.
/// Pairs of triangles are always tried with every size.
inline constexpr bool extreme_models_are_fuzzed = false;

/// Library calls in floating-point environments other than the default one; see environment.h.
inline constexpr bool environments_are_fuzzed = false;

/// Updates whose spans refer to the model's own positions. They mean what a copy of the spans would mean.
inline constexpr bool aliased_updates_are_fuzzed = false;

/// Use of models that were moved from, which must throw std::logic_error.
inline constexpr bool moved_from_models_are_fuzzed = false;

/// Whether errors that quote what they refuse must keep zero bytes, and those of poses ends of lines, out of the quote.
inline constexpr bool quoted_text_is_fuzzed = false;

/// Queries of uncommitted models and with poses that are not rigid, which must throw std::logic_error.
#if defined(LIMBER_CHECKS)
inline constexpr bool misuse_is_fuzzed = true;
#else
inline constexpr bool misuse_is_fuzzed = false;
#endif

}  // namespace limber::fuzz
