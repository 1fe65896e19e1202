// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * What was wrong: the codes of C++, and those for mistakes of the caller.
 *
 * @typedef {typeof codesOfResults[number] | typeof otherCodes[number] | "disposed" | "notInitialized"} ErrorCode
 */

/** In the order of limber::ErrorCode. */
const codesOfResults = /** @type {const} */ (["emptyMesh", "nonFinite", "tooLarge", "indexOutOfRange", "sizeMismatch",
  "notRigid", "unreadableFile", "malformedFile", "unsupportedFormat", "changedConnectivity", "brokenInvariant",
  "notClosed"]);

/** Numbers of clients/javascript/src/bindings.cpp beyond those of limber::ErrorCode. */
const firstOtherCode = 100;
const otherCodes = /** @type {const} */ (["invalidArgument", "outOfMemory", "other"]);

/** Whatever this package throws. */
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
export const codeOf = (number) => codesOfResults[number] ?? otherCodes[number - firstOtherCode] ?? "other";

/** The error for an argument that is not what its comment says. @param {string} message */
export const invalid = (message) => new LimberError("invalidArgument", `limber3d: ${message}`);
