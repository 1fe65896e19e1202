// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// WebAssembly gives the answers of the native library, to the bit. answers.cpp writes calls and answers, a line of JSON
// each; the environment's LIMBER_ANSWERS names the file.
import assert from "node:assert/strict";
import { createReadStream } from "node:fs";
import { createInterface } from "node:readline";
import { test } from "node:test";
import * as limber from "limber3d";
import { row } from "../limber3d/wasm.js";

/** Compares with what JSON has: numbers to the bit, where 0 and -0 differ, and arrays of any kind. */
function same(actual, expected, what) {
  if (typeof actual === "number") {
    assert.ok(Object.is(actual, Number(expected)), `${what}: ${actual} in WebAssembly, ${expected} natively`);
  } else if (Array.isArray(expected)) {
    assert.equal(actual.length, expected.length, what);
    for (let i = 0; i < expected.length; ++i) same(actual[i], expected[i], `${what}[${i}]`);
  } else if (typeof expected === "object" && expected !== null) {
    assert.ok(typeof actual === "object" && actual !== null, what);
    for (const name of Object.keys(expected)) same(actual[name], expected[name], `${what}.${name}`);
  } else {
    assert.equal(actual, expected, what);
  }
}

const models = [], caches = [], moving = [], shapes = [];
const firstShape = 1000;
let scene;

/** An argument as it is given: typed arrays come with the name of their type. */
function given(argument) {
  const [type] = Object.keys(argument ?? {});
  const isTyped = typeof argument === "object" && type?.endsWith("Array");
  return isTyped ? globalThis[type].from(argument[type]) : argument;
}

/** The numbers of a result, as answers.cpp writes them: those of many answers, or those that one was made of. */
function numbersOf(result) {
  if (result?.objects !== undefined) return { ...result, result: numbersOf(result.result) };
  if (result?.stats === undefined || "at" in result) return result;
  return row("time" in result ? "rigidImpact" : "elements" in result ? "impact" : "isYes" in result ? "collide"
    : "distance");
}

/** Calls that are no functions of the package; others are. */
const calls = {
  Model(_, ...args) {
    models.push(new limber.Model(...args));
    caches.push(new limber.QueryCache());
    moving.push(new limber.MovingModel(models.at(-1)));
  },
  Shape: (_, name, ...args) => void shapes.push(limber.Shape[name](...args)),
  moveAll(model, positions) {
    model.moveAll(positions);
    model.commit();
  },
  moveVertices(model, ids, positions) {
    model.moveVertices(ids, positions);
    model.commit();
  },
  rebuild: (model) => model.rebuild(),
  signedDistanceMany(model, points, options) {
    const surface = new limber.ClosedSurface(model), found = surface.signedDistanceMany(points, options);
    surface.dispose();
    return found;
  },
  sceneAdd(model, pose) {
    scene ??= new limber.Scene();
    return scene.add(model, pose);
  },
  sceneCall: (_, name, ...args) => scene[name](...args),
  setMotion: (model, ...args) => model.setMotion(...args),
};

const ofMotion = ["setMotion", "timeOfImpact", "selfTimeOfImpact"];
const functions = { ...limber, rigidTimeOfImpact: limber.timeOfImpact, ...calls };

function ask({ call, of, args, options }) {
  const asked = of.map((i) => (ofMotion.includes(call) ? moving : models)[i] ?? shapes[i - firstShape]);
  const { rings, cache, maxDistance, motions, ...others } = options ?? {};
  if (cache) others.cache = caches[of[0]];
  if (maxDistance !== undefined) others.maxDistance = Number(maxDistance);
  if (rings !== undefined) others.filter = new limber.NeighborRings(asked[0], rings);
  if (motions) [others.motionA, others.motionB] = motions.map((poses) => new limber.RigidMotion(...poses));
  const subjects = call in calls ? [asked[0]] : asked, last = options === null ? [] : [others];
  const result = functions[call](...subjects, ...args.map(given), ...last);
  for (const used of [others.filter, others.motionA, others.motionB]) used?.dispose();
  return result;
}

test("every answer has the bits of the native library's", async () => {
  assert.ok(process.env.LIMBER_ANSWERS, "LIMBER_ANSWERS names the file that limber_web_answers has written");
  await limber.init();
  const counts = {};
  let line = 0;
  for await (const text of createInterface({ input: createReadStream(process.env.LIMBER_ANSWERS) })) {
    const question = JSON.parse(text), { call, answer } = question;
    counts[call] = (counts[call] ?? 0) + 1;
    const result = ask(question), what = `line ${++line}, ${call}`;
    if (answer !== null) same(numbersOf(result), answer, what);
  }
  const queries = ["distance", "collide", "within", "contacts", "selfCollide", "selfDistance", "selfContacts",
    "closestPointMany", "timeOfImpact", "selfTimeOfImpact", "rigidTimeOfImpact"];
  for (const name of [...queries, ...Object.keys(calls)]) assert.ok(counts[name] > 0, `nothing was asked of ${name}`);
  console.log(counts);
});
