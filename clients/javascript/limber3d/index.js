// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Collision and distance for triangle meshes that deform: what the package exports.

export { Model, NeighborRings, QueryCache, Shape } from "./bodies.js";
export { LimberError } from "./errors.js";
export * from "./motion.js";
export * from "./queries.js";
export * from "./scene.js";
export * from "./types.js";
export { init } from "./wasm.js";

/** @typedef {import("./errors.js").ErrorCode} ErrorCode */
