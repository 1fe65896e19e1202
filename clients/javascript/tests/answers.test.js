// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// WebAssembly gives the answers of the native library, to the bit. answers.cpp writes calls and answers, a line of JSON
// each; the environment's LIMBER_ANSWERS names the file.
import assert from "node:assert/strict";
import { createReadStream } from "node:fs";
import { createInterface } from "node:readline";
import { test } from "node:test";
import * as limber from "limber3d";

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
let scene, sceneCache;

/** An argument as it is given: typed arrays come with the name of their type, NaN as null. */
function given(argument) {
  const [type] = Object.keys(argument ?? {});
  const isTyped = typeof argument === "object" && type?.endsWith("Array");
  return isTyped ? globalThis[type].from(argument[type], (x) => x ?? NaN) : argument;
}

/** What a result says, as answers.cpp writes it. */
function said(result) {
  if (result?.contacts instanceof limber.Contacts) return { ...result, contacts: [...result.contacts] };
  if (result instanceof limber.Contacts) return { ...result, contacts: [...result] };
  if (result instanceof limber.Impacts) return { ...result, impacts: [...result] };
  if (result instanceof limber.CollideResults || result instanceof limber.DistanceResults) {
    if (result.objects.length === 0) return [...result];
    return [...result].map((one, i) => ({ objects: result.objectsAt(i), result: one }));
  }
  return result instanceof limber.PointResults ? [...result] : result;
}

/** Calls that are no functions of the package; others are. */
const calls = {
  Model(_, ...args) {
    models.push(new limber.Model(...args));
    caches.push(new limber.QueryCache());
    moving.push(new limber.MovingModel(models.at(-1)));
  },
  Shape(_, name, ...args) {
    shapes.push(limber.Shape[name](...args));
    return shapes.at(-1);
  },
  moveAll: (model, positions) => model.moveAll(positions),
  moveVertices: (model, ...args) => model.moveVertices(...args),
  commit: (model) => model.commit(),
  signedDistanceMany(model, points, options) {
    const surface = new limber.ClosedSurface(model), found = surface.signedDistanceMany(points, options);
    surface.dispose();
    return found;
  },
  sceneAdd(model, pose) {
    scene ??= new limber.Scene();
    sceneCache ??= new limber.SceneCache();
    return scene.add(model, pose);
  },
  sceneCall(_, name, ...args) {
    const options = args.pop(), { sceneCache: usesCache, leftOut, ...others } = options;
    if (usesCache) others.cache = sceneCache;
    if (leftOut) {
      others.filter = new limber.ObjectPairMatrix(scene.idBound);
      others.filter.set(...leftOut, false);
    }
    const hasOptions = Object.keys(others).length > 0;
    const result = hasOptions ? scene[name](...args, others) : scene[name](...args);
    others.filter?.dispose();
    return result;
  },
  sceneNextTo(body, name, ...args) {
    const { leftOut, ...options } = args.pop();
    if (leftOut !== undefined) options.filter = (id) => id !== leftOut;
    return scene[name](body, ...args, options);
  },
  edges: (model) => model.edges(),
  setMotion: (model, ...args) => model.setMotion(...args),
  tree(model) {
    model.validate();
    const spheres = Array.from({ length: model.treeStats().levels }, (_, level) => model.nodeSpheres(level));
    return { box: model.boundingBox(), maintenance: model.maintenanceStats(), spheres };
  },
};

const withOptions = ["signedDistanceMany", "setMotion", "sceneCall", "sceneNextTo"];
const ofSurfaces = ["solidRelation", "deepestVertices", "separatingTranslation", "signedDistance"];
const ofContacts = ["poseGradientA", "poseGradientB", "vertexGradientsA", "vertexGradientsB"];
const withoutOptions = [...ofContacts, "weld", "readMeshBytes"];
const ofMotion = ["setMotion", "timeOfImpact", "selfTimeOfImpact", "impacts", "selfImpacts"];
const functions = { ...limber, pathImpact: limber.timeOfImpact };

function ask({ call, of, args, options }) {
  const asked = of.map((i) => (ofMotion.includes(call) ? moving : models)[i] ?? shapes[i - firstShape]);
  const { rings: edges, cache, maxDistance, motions, ...others } = options ?? {};
  if (cache) others.cache = caches[of[0]];
  if (maxDistance !== undefined) others.maxDistance = Number(maxDistance);
  if (edges !== undefined) others.filter = new limber.NeighborRings(asked[0], edges);
  if (motions) [others.motionA, others.motionB] = motions.map((poses) => new limber.RigidMotion(...poses));
  if (call in calls) return calls[call](asked[0], ...args.map(given), ...(withOptions.includes(call) ? [others] : []));
  const bodies = ofSurfaces.includes(call) ? asked.map((model) => new limber.ClosedSurface(model)) : [];
  const last = withoutOptions.includes(call) ? [] : [others];
  const result = functions[call](...(bodies.length > 0 ? bodies : asked), ...args.map(given), ...last);
  for (const used of [others.filter, others.motionA, others.motionB, ...bodies]) used?.dispose();
  return result;
}

test("every answer has the bits of the native library's", async () => {
  assert.ok(process.env.LIMBER_ANSWERS, "LIMBER_ANSWERS names the file that limber_web_answers has written");
  await limber.init();
  const counts = {};
  let line = 0;
  for await (const text of createInterface({ input: createReadStream(process.env.LIMBER_ANSWERS) })) {
    const question = JSON.parse(text), { call, answer } = question;
    const what = `line ${++line}, ${call}`;
    counts[call] = (counts[call] ?? 0) + 1;
    if (answer?.error === undefined) {
      const result = ask(question);
      if (answer !== null) same(said(result), answer, what);
      continue;
    }
    assert.throws(() => ask(question), (error) => {
      assert.ok(error instanceof limber.LimberError, what);
      const { code, message, where } = error;
      assert.deepEqual({ code, message, where }, { where: undefined, ...answer.error }, what);
      return true;
    });
  }
  const names = ["distance", "collide", "within", "contacts", "intersections", "closestPairs", "selfCollide",
    "selfDistance", "selfContacts", "selfIntersections", "selfClosestPairs", "closestPointMany", "readMeshBytes",
    "vertexFaceImpact", "edgeEdgeImpact", "timeOfImpact", "selfTimeOfImpact", "impacts", "selfImpacts", "pathImpact",
    "minDistance", "contactOf", ...ofSurfaces, ...withoutOptions];
  for (const name of [...names, ...Object.keys(calls)]) assert.ok(counts[name] > 0, `nothing was asked of ${name}`);
  console.log(counts);
});
