// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// WebAssembly gives the answers of the native library, to the bit. answers.cpp writes questions and answers; the
// environment's LIMBER_ANSWERS names the file.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { before, test } from "node:test";
import * as limber from "limber3d";

class Reader {
  #bytes;
  #view;
  #at = 0;

  constructor(bytes) {
    this.#bytes = bytes;
    this.#view = new DataView(bytes);
  }
  get isAtEnd() {
    return this.#at === this.#bytes.byteLength;
  }
  number() {
    this.#at += 8;
    return this.#view.getFloat64(this.#at - 8, true);
  }
  numbers(count) {
    return Array.from({ length: count }, () => this.number());
  }
  array(Type) {
    const bytes = this.number(), first = this.#at;
    this.#at = Math.ceil((first + bytes) / 8) * 8;
    return new Type(this.#bytes.slice(first, first + bytes));
  }
  text() {
    return new TextDecoder().decode(this.array(Uint8Array));
  }
  positions() {
    return this.array(this.number() === 1 ? Float32Array : Float64Array);
  }
}

// By their numbers in answers.cpp.
const statuses = ["exact", "withinError", "collision", "beyondLimit", "interrupted"];
const answers = ["no", "yes", "unknown"];
const limits = ["nothing", "deadline", "maxSteps"];
const kinds = ["vertex", "edge", "face"];
const codes = ["emptyMesh", "nonFinite", "tooLarge", "indexOutOfRange", "sizeMismatch", "notRigid", "unreadableFile",
  "malformedFile", "unsupportedFormat", "changedConnectivity", "brokenInvariant", "notClosed"];

const bits = (x) => new BigUint64Array(Float64Array.of(x).buffer)[0];

/** Compares to the bit: 0 and -0 differ. */
function same(actual, expected, what) {
  assert.equal(typeof actual, "number", what);
  if (!Object.is(actual, expected) || bits(actual) !== bits(expected)) {
    assert.fail(`${what}: ${actual} in WebAssembly, ${expected} natively`);
  }
}
function sameAll(actual, expected, what) {
  assert.equal(actual.length, expected.length, what);
  for (let i = 0; i < expected.length; ++i) same(actual[i], expected[i], `${what} [${i}]`);
}

const models = [], caches = [], counts = new Map();
let reader;

const model = () => models[reader.number()];
function pair() {
  const a = reader.number(), b = reader.number();
  return [models[a], models[b], { poseA: null, poseB: reader.numbers(16) }, caches[a]];
}
function budget(options, cache) {
  options.budget = { maxSteps: reader.number() };
  if (reader.number() === 1) options.cache = cache;
}

function sameStats(stats) {
  same(stats.nodeTests, reader.number(), "nodeTests");
  same(stats.triangleTests, reader.number(), "triangleTests");
}
function sameWitness(witness) {
  if (reader.number() === 0) return assert.equal(witness, null);
  sameAll([...witness.pointA, ...witness.pointB], reader.numbers(6), "witness");
  sameAll([witness.triangleA, witness.triangleB], reader.numbers(2), "triangles");
}
function sameDistance(result) {
  sameAll([result.lower, result.upper], reader.numbers(2), "interval");
  assert.equal(result.status, statuses[reader.number()]);
  assert.equal(result.stoppedBy, limits[reader.number()]);
  sameWitness(result.witness);
  sameStats(result.stats);
}
function sameAnswer(result) {
  assert.equal(result.answer, answers[reader.number()]);
  assert.equal(result.stoppedBy, limits[reader.number()]);
  sameWitness(result.witness);
  sameStats(result.stats);
}
function sameContacts(found) {
  assert.equal(found.count, reader.number());
  let i = 0;
  for (const contact of found) {
    sameAll([contact.distance, contact.depth], reader.numbers(2), `contact ${i}`);
    sameAll([...contact.pointA, ...contact.pointB, ...contact.normal], reader.numbers(9), `vectors of contact ${i}`);
    sameAll([contact.triangleA, contact.triangleB], reader.numbers(2), `triangles of contact ${i}`);
    for (const feature of [contact.featureA, contact.featureB]) {
      assert.equal(feature.kind, kinds[reader.number()]);
      same(feature.index, reader.number(), "feature");
    }
    assert.equal(contact.normalSide, ["unknown", "outward", "inward"][reader.number()]);
    ++i;
  }
  assert.equal(i, found.count);
  sameStats(found.stats);
}
function samePairs(found) {
  const expected = reader.array(Uint32Array);
  assert.equal(found.count, expected.length / 2);
  assert.ok(found.isComplete);
  assert.deepEqual(found.triangles, expected);
  sameStats(found.stats);
}
function samePoints(found) {
  for (let i = 0; i < found.count; ++i) {
    const isFound = reader.number() === 1;
    assert.equal(found.isInside(i), reader.number() === 1);
    const closest = found.at(i);
    assert.equal(closest !== null, isFound);
    if (!isFound) continue;
    same(closest.distance, reader.number(), "distance");
    same(found.distances[i], found.isInside(i) ? -closest.distance : closest.distance, "signed distance");
    sameAll(closest.position, reader.numbers(3), "position");
    same(closest.triangle, reader.number(), "triangle");
    sameAll(closest.barycentric, reader.numbers(3), "barycentric");
    assert.equal(closest.feature.kind, kinds[reader.number()]);
    same(closest.feature.index, reader.number(), "feature");
  }
}
function sameError(error) {
  assert.ok(error instanceof limber.LimberError, String(error));
  const code = codes[reader.number()], text = reader.text(), where = reader.number();
  assert.equal(error.message, text);
  assert.equal(error.code, code);
  assert.equal(error.where, where < 0 ? undefined : where);
}
function thrownBy(body) {
  try {
    body();
  } catch (error) {
    return error;
  }
  return undefined;
}

// In the order of Question in answers.cpp.
const questions = {
  model() {
    const positions = reader.positions();
    models.push(new limber.Model(positions, reader.array(Uint32Array)));
    caches.push(new limber.QueryCache());
  },
  moveAll() {
    model().moveAll(reader.positions());
  },
  moveVertices() {
    const moved = model(), positions = reader.positions();
    moved.moveVertices(reader.array(Uint32Array), positions);
  },
  commit() {
    model().commit();
  },
  distance() {
    const [a, b, options, cache] = pair();
    [options.relativeError, options.absoluteError, options.maxDistance] = reader.numbers(3);
    budget(options, cache);
    sameDistance(limber.distance(a, b, options));
  },
  collide() {
    const [a, b, options, cache] = pair();
    budget(options, cache);
    sameAnswer(limber.collide(a, b, options));
  },
  within() {
    const [a, b, options] = pair();
    sameAnswer(limber.within(a, b, reader.number(), options));
  },
  contacts() {
    const [a, b, options] = pair();
    sameContacts(limber.contacts(a, b, reader.number(), options));
  },
  intersections() {
    samePairs(limber.intersections(...pair()));
  },
  closestPairs() {
    const [a, b, options] = pair();
    sameContacts(limber.closestPairs(a, b, reader.number(), options));
  },
  selfCollide() {
    sameAnswer(limber.selfCollide(model()));
  },
  selfDistance() {
    const asked = model(), rings = new limber.NeighborRings(asked, reader.number());
    sameDistance(limber.selfDistance(asked, { filter: rings }));
    rings.dispose();
  },
  selfContacts() {
    const asked = model(), margin = reader.number(), rings = new limber.NeighborRings(asked, reader.number());
    sameContacts(limber.selfContacts(asked, margin, { filter: rings }));
    rings.dispose();
  },
  selfIntersections() {
    samePairs(limber.selfIntersections(model()));
  },
  selfClosestPairs() {
    const asked = model();
    sameContacts(limber.selfClosestPairs(asked, reader.number()));
  },
  closestPoints() {
    const asked = model(), pose = reader.numbers(16), points = reader.array(Float64Array);
    samePoints(limber.closestPoints(asked, points, { pose, maxDistance: reader.number() }));
  },
  signedDistances() {
    const surface = new limber.ClosedSurface(model()), pose = reader.numbers(16);
    samePoints(surface.signedDistances(reader.array(Float64Array), { pose }));
    surface.dispose();
  },
  tree() {
    const asked = model(), { low, high } = asked.boundingBox(), stats = asked.maintenanceStats();
    sameAll([...low, ...high], reader.numbers(6), "box");
    const { movedVertices, refits, wholePasses, rebuiltTriangles, rebuildUs } = stats;
    sameAll([movedVertices, refits, wholePasses, rebuiltTriangles, rebuildUs], reader.numbers(5), "maintenance");
    const levels = reader.number();
    assert.equal(asked.treeStats().levels, levels);
    for (let level = 0; level < levels; ++level) {
      sameAll(asked.nodeSpheres(level), reader.array(Float64Array), `spheres of level ${level}`);
    }
    asked.validate();
  },
  file() {
    const name = reader.text(), bytes = reader.array(Uint8Array);
    let file;
    const error = thrownBy(() => (file = limber.readMeshBytes(bytes, name)));
    if (reader.number() === 0) return sameError(error);
    assert.equal(error, undefined);
    sameAll(file.vertices, reader.array(Float64Array), name);
    assert.deepEqual(file.faces, reader.array(Uint32Array));
    assert.deepEqual(file.faceOfTriangle, reader.array(Uint32Array));
    same(file.faceCount, reader.number(), "faceCount");
  },
  error() {
    const asked = model(), positions = reader.positions();
    sameError(thrownBy(() => asked.moveAll(positions)));
  },
};

before(() => limber.init());

test("every answer has the bits of the native library's", () => {
  assert.ok(process.env.LIMBER_ANSWERS, "LIMBER_ANSWERS names the file that limber_web_answers has written");
  const { buffer, byteOffset, byteLength } = readFileSync(process.env.LIMBER_ANSWERS);
  reader = new Reader(buffer.slice(byteOffset, byteOffset + byteLength));
  const names = Object.keys(questions);
  for (let i = 0; !reader.isAtEnd; ++i) {
    const name = names[reader.number()];
    try {
      questions[name]();
    } catch (error) {
      error.message = `question ${i}, ${name}: ${error.message}`;
      throw error;
    }
    counts.set(name, (counts.get(name) ?? 0) + 1);
  }
  for (const name of names) assert.ok(counts.get(name) > 0, `nothing was asked of ${name}`);
  console.log(Object.fromEntries(counts));
});
