// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The first program of docs/guide/javascript.md runs as it stands there.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const page = new URL("../../../docs/guide/javascript.md", import.meta.url); // tests run in build/web/tests

test("the program of the guide runs", { skip: !existsSync(page) && "the tests stand outside of the sources" }, () => {
  const program = readFileSync(page, "utf8").match(/^```js\n(.*?)^```/ms);
  assert.ok(program?.[1]);
  const file = fileURLToPath(new URL("guide_program.mjs", import.meta.url));
  writeFileSync(file, program[1]);
  try {
    const output = execFileSync(process.execPath, [file], { encoding: "utf8" });
    assert.equal(output.split("\n")[1], "frame 1: 1 apart, 0 contacts");
    assert.equal(output.split("\n")[3], "frame 3: 0 apart, 12 contacts");
  } finally {
    rmSync(file);
  }
});
