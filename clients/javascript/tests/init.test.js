// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How the module is loaded. The tests depend on their order.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
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

test("the module is fetched, whatever its type", async () => {
  const bytes = readFileSync(new URL("../limber3d/limber.wasm", import.meta.url));
  const server = createServer((request, response) => {
    const types = { "/typed.wasm": "application/wasm", "/page.wasm": "text/html; charset=utf-8" };
    const type = types[request.url] ?? "application/octet-stream";
    response.writeHead(request.url === "/missing.wasm" ? 404 : 200, { "Content-Type": type, Connection: "close" });
    response.end(bytes);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const address = `http://127.0.0.1:${server.address().port}`;
  try {
    for (const name of ["typed", "plain"]) {
      const { engine, init } = await import(`../limber3d/wasm.js?${name}`);  // an instance of its own
      await assert.rejects(init(`${address}/missing.wasm`), { code: "unreadableFile", message: /missing.wasm: 404/ });
      await assert.rejects(init(`${address}/page.wasm`), { code: "unreadableFile", message: /page.wasm: a page of/ });
      assert.throws(engine, isNotInitialized);
      await init(new URL(`${address}/${name}.wasm`));
      assert.ok(engine().exchange() > 0);
    }
    const { engine, init } = await import("../limber3d/wasm.js?response");
    await init(await fetch(`${address}/typed.wasm`));
    assert.ok(engine().exchange() > 0);
  } finally {
    server.close();
  }
});
