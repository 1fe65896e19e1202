// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Question  How much slower is the engine in WebAssembly than natively on one thread, and does a frame fit in 4 ms?
// Workload  native.cpp, which runs the same beside this, turn by turn; answers must be equal to the bit.
// Metric    Minima and medians, the lowest of several turns of each, and ratios of minima, which suffer least from what
//           else the machine does; sizes of the module; time to compile and start it.
// Expected  A ratio of 1.5 to 3: vectors of 4 numbers for 8, and bounds checks.
//
// usage: node bench.js NATIVE_PROGRAM FOLDER_OF_MESHES [TURNS]
import { spawnSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { brotliCompressSync, gzipSync } from "node:zlib";
import * as limber from "limber3d";

const [program, folder, turns = "3"] = process.argv.slice(2);
const module_ = readFileSync(new URL("../limber3d/limber.wasm", import.meta.url));

/** @type {Map<string, { answer: number, least: number, median: number }>} */
let measured = new Map();

function measure(name, runs, body) {
  const us = [];
  let answer = 0;
  for (let i = 0; i < runs; ++i) {
    const start = performance.now();
    answer += body(i);
    us.push(1000 * (performance.now() - start));
  }
  us.sort((a, b) => a - b);
  measured.set(name, { answer, least: us[0], median: us[runs >> 1] });
}

const squares = 100;

function wave(x) {
  const u = x - Math.floor(x), v = u < 0.5 ? u : u - 0.5;
  return (u < 0.5 ? 16 : -16) * v * (0.5 - v);
}

function sheetPositions(frame) {
  const positions = new Float32Array(3 * (squares + 1) ** 2);
  for (let j = 0, k = 0; j <= squares; ++j) {
    for (let i = 0; i <= squares; ++i) {
      const x = 0.004 * i - 0.2, y = 0.004 * j - 0.1;
      positions[k++] = x;
      positions[k++] = y;
      positions[k++] = 0.12 + 0.01 * wave(6 * x + 0.06 * frame) * wave(8 * y - 0.04 * frame);
    }
  }
  return positions;
}

function sheetTriangles() {
  const triangles = [];
  for (let j = 0; j < squares; ++j) {
    for (let i = 0; i < squares; ++i) {
      const a = j * (squares + 1) + i, d = a + squares + 1;
      triangles.push(a, a + 1, d + 1, a, d + 1, d);
    }
  }
  return new Uint32Array(triangles);
}

const shift = (x, y) => ({ translation: [x, y, 0] });

function run() {
  measured = new Map();
  const read = (name) => limber.readMeshBytes(readFileSync(`${folder}/${name}`), name);
  measure("read stanford-bunny.obj", 5, () => read("stanford-bunny.obj").faces.length / 3);
  const { vertices, faces } = read("stanford-bunny.obj");
  measure("build a tree of 69 451 triangles", 5, () => {
    const model = new limber.Model(vertices, faces), { radius } = model.boundingSphere();
    model.dispose();
    return radius;
  });
  const file = read("armadillo.obj");
  const bunny = new limber.Model(vertices, faces), armadillo = new limber.Model(file.vertices, file.faces);

  const sheet = new limber.Model(sheetPositions(0), sheetTriangles());
  const frames = Array.from({ length: 300 }, (_, frame) => sheetPositions(frame));
  measure("frame: move 20 000 triangles, commit, distance to 69 451", 300, (i) => {
    sheet.moveAll(frames[i]);
    sheet.commit();
    return limber.distance(sheet, bunny).upper;
  });
  measure("move_all of 10 201 vertices", 300, (i) => {
    sheet.moveAll(frames[i]);
    return 0;
  });
  const ids = Uint32Array.from({ length: 500 }, (_, i) => i), moved = frames[0].slice(0, 1500);
  measure("move_vertices of 500 and commit", 300, (i) => {
    for (let v = 0; v < 500; ++v) moved[3 * v + 2] = 0.125 + 0.0009765625 * (i % 7);
    sheet.moveVertices(ids, moved);
    sheet.commit();
    return 0;
  });
  measure("contacts of sheet and bunny within 0.002", 100, (i) => {
    const poseB = { translation: [0, 0, 0.0546875 + 0.0009765625 * (i % 8)] };
    return limber.contacts(sheet, bunny, 0.002, { poseB }).count;
  });

  measure("distance of bunny and armadillo", 400, (i) => {
    const poseB = shift(0.9 - 0.0009765625 * i, 0.015625 * (i % 7));
    return limber.distance(bunny, armadillo, { poseB }).upper;
  });
  const cache = new limber.QueryCache();
  measure("the same with a cache", 400, (i) => {
    return limber.distance(bunny, armadillo, { poseB: shift(0.9 - 0.0009765625 * i, 0), cache }).upper;
  });
  measure("the same within 10 %", 400, (i) => {
    const poseB = shift(0.9 - 0.0009765625 * i, 0.015625 * (i % 7));
    return limber.distance(bunny, armadillo, { poseB, relativeError: 0.1 }).upper;
  });
  measure("collide of bunny and armadillo", 400, (i) => {
    const poseB = shift(0.6 - 0.0009765625 * i, 0.015625 * (i % 7));
    return limber.collide(bunny, armadillo, { poseB }).answer === "yes" ? 1 : 0;
  });
  measure("self_collide of 69 451 triangles", 20, () => (limber.selfCollide(bunny).answer === "yes" ? 1 : 0));
  const points = Float64Array.from({ length: 300 }, (_, k) => {
    const i = Math.floor(k / 3);
    return [0.001 * (i % 37) - 0.02, 0.001 * (i % 101), 0.001 * (i % 53) + 0.05][k % 3];
  });
  measure("closest points of 100 points and bunny", 200, () => limber.closestPoints(bunny, points).distances[50]);

  const one = new limber.Model([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);
  const options = { poseB: { elements: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1] } };
  measure("100 distances of two triangles, with a pose", 2000, () => {
    let sum = 0;
    for (let i = 0; i < 100; ++i) sum += limber.distance(one, one, options).upper;
    return sum;
  });
  for (const owner of [bunny, armadillo, sheet, cache, one]) owner.dispose();
  return measured;
}

/** What %a of C prints. */
function fromHexadecimal(text) {
  const [, sign, whole, fraction, exponent] = /^(-?)0x([0-9a-f])\.?([0-9a-f]*)p([-+]\d+)$/.exec(text);
  return (sign ? -1 : 1) * parseInt(whole + fraction, 16) * 2 ** (Number(exponent) - 4 * fraction.length);
}

function runNatively() {
  const { stdout, status, stderr } = spawnSync(program, [folder], { encoding: "utf8" });
  if (status !== 0) throw new Error(stderr);
  return new Map(
    stdout.trim().split("\n").map((line) => {
      const [name, answer, least, median] = line.split("\t");
      return [name, { answer: fromHexadecimal(answer), least: Number(least), median: Number(median) }];
    }),
  );
}

const starts = [];
for (let i = 0; i < 9; ++i) {
  const start = performance.now();
  const imports = { limber: { now: () => 0, filter: () => 0 }, env: { emscripten_notify_memory_growth() {} } };
  await WebAssembly.instantiate(module_, { ...imports, wasi_snapshot_preview1: { proc_exit() {} } });
  starts.push(performance.now() - start);
}
await limber.init();

const best = new Map();
for (let turn = 0; turn < Number(turns); ++turn) {
  const native = runNatively();
  for (const [name, { answer, ...wasm }] of run()) {
    const beside = native.get(name);
    if (beside?.answer !== answer) throw new Error(`${name}: ${answer}, natively ${beside?.answer}`);
    const before = best.get(name) ?? { native: beside, wasm };
    const lower = (a, b) => ({ least: Math.min(a.least, b.least), median: Math.min(a.median, b.median) });
    best.set(name, { native: lower(before.native, beside), wasm: lower(before.wasm, wasm) });
  }
}

const kB = (bytes) => `${(bytes / 1000).toFixed(0)} kB`;
console.log("# The engine in WebAssembly, next to the native one\n");
console.log(`limber.wasm: ${kB(module_.length)}, ${kB(gzipSync(module_, { level: 9 }).length)} by gzip, ` +
  `${kB(brotliCompressSync(module_).length)} by brotli; compiled and started in ` +
  `${starts.sort((a, b) => a - b)[4].toFixed(1)} ms (Node.js ${process.version}).\n`);
console.log("Minimum and median; native on one thread; ratio of minima.\n");
console.log("| workload | native | WebAssembly | ratio |\n|:--|--:|--:|--:|");
for (const [name, { native, wasm }] of best) {
  const shown = (us) => (us < 1000 ? `${us.toPrecision(3)} us` : `${(us / 1000).toPrecision(3)} ms`);
  const both = ({ least, median }) => `${shown(least)}, ${shown(median)}`;
  console.log(`| ${name} | ${both(native)} | ${both(wasm)} | ${(wasm.least / native.least).toFixed(2)} |`);
}
