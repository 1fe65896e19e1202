// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How the module is loaded. The tests depend on their order.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import * as limber from "limber3d";

const triangle = () => new limber.Model([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);
const isNotInitialized = { name: "LimberError", code: "notInitialized", message: /init\(\)/ };

test("nothing works before init()", () => {
  assert.throws(triangle, isNotInitialized);
  assert.throws(() => limber.orthonormalized(new Float64Array(9)), isNotInitialized);
});

test("init() fails as its source does, and may be repeated", async () => {
  await assert.rejects(limber.init(new Uint8Array([1, 2, 3])), WebAssembly.CompileError);
  const bytes = readFileSync(new URL("../limber3d/limber.wasm", import.meta.url));
  await limber.init(await WebAssembly.compile(bytes));
  const model = triangle();
  await limber.init();
  assert.equal(model.triangleCount, 1, "a second init() must leave the first one alone");
});
