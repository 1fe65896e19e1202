// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * What was wrong: the codes of C++, and those for mistakes of the caller.
 *
 * @typedef {typeof codesOfResults[number] | typeof otherCodes[number] | "disposed" | "busy" | "notInitialized"}
 *   ErrorCode
 */

/** In the order of limber::ErrorCode. */
const codesOfResults = /** @type {const} */ ([
  "emptyMesh",
  "nonFinite",
  "tooLarge",
  "indexOutOfRange",
  "sizeMismatch",
  "notRigid",
  "unreadableFile",
  "malformedFile",
  "unsupportedFormat",
  "changedConnectivity",
  "brokenInvariant",
  "notClosed",
]);

/** Numbers of clients/javascript/src/bindings.cpp beyond those of limber::ErrorCode. */
const firstOtherCode = 100;
const otherCodes = /** @type {const} */ (["invalidArgument", "outOfMemory", "other", "other"]);

/** Whatever this package throws, but for errors that filters throw. */
export class LimberError extends Error {
  /**
   * @param {ErrorCode} code
   * @param {string} message
   * @param {number} [where]
   */
  constructor(code, message, where) {
    super(message);
    this.name = "LimberError";
    /** For programs; the message is for people. */
    this.code = code;
    /** Index of the offending vertex, triangle or entry, where there is one. */
    this.where = where;
  }
}

/**
 * The code for a number of the module.
 *
 * @param {number} number
 * @returns {ErrorCode}
 */
export function codeOf(number) {
  return codesOfResults[number] ?? otherCodes[number - firstOtherCode] ?? "other";
}

/** The number that says that a filter has thrown. */
export const filterHasThrown = firstOtherCode + 2;

/**
 * The error for an argument that is not what its comment says. Private to the package.
 *
 * @param {string} message
 */
export function invalid(message) {
  return new LimberError("invalidArgument", `limber3d: ${message}`);
}
