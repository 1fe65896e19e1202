// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Continuous collision: elements, moving models, rigid bodies on their way.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { corners, faces, grid, refuses, tetrahedron } from "./support.js";

before(() => limber.init());

/** A moving model of these arrays, which goes to `end` or stays. */
function moving(vertices, triangles, end = vertices, poses = {}) {
  const model = new limber.MovingModel(new limber.Model(vertices, triangles));
  model.setMotion(end, poses);
  return model;
}

/** The plate z = 0 over [-3, 3] x [-3, 3]. */
const plateVertices = [-3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0], plateFaces = [0, 1, 2, 0, 2, 3];
const plate = () => moving(plateVertices, plateFaces);
const above = (z) => ({ translation: [0.1, 0.2, z] });
/** A tetrahedron that falls from one height to another. Its lowest face is flat. */
const falling = (from, to) => moving(corners, faces, corners, { startPose: above(from), endPose: above(to) });

/** A copy with another number. */
const changed = (numbers, i, number) => Object.assign([...numbers], { [i]: number });

const isNear = (actual, expected, error, what) =>
  assert.ok(Math.abs(actual - expected) <= error, `${what ?? ""} ${actual} is not ${expected}`);

const face = [0, 0, 0, 1, 0, 0, 0, 1, 0];
const never = { status: "clear", lower: Infinity, upper: Infinity };
const atOnce = { status: "initialContact", lower: 0, upper: 0 };

test("a vertex and a face touch at the time that is known", () => {
  for (const kind of [Array.from, (numbers) => Float32Array.from(numbers), (numbers) => Float64Array.from(numbers)]) {
    const ask = (from, to, options) =>
      limber.vertexFaceImpact(kind([...from, ...face]), kind([...to, ...face]), options);
    assert.deepEqual(ask([0.25, 0.25, 3], [0.25, 0.25, -1]), { status: "contact", lower: 0.75, upper: 0.75 });
    assert.deepEqual(ask([0.25, 0.25, 3], [0.25, 0.25, -1], { maxTime: 0.5 }), never);
    assert.deepEqual(ask([2, 2, 3], [2, 2, -1]), never);
    assert.deepEqual(ask([0.25, 0.25, 0], [0.25, 0.25, 1]), atOnce);
    // In the plane of the face, past a corner at a single instant.
    assert.deepEqual(ask([2, -1, 0], [0, 1, 0]), { status: "contact", lower: 0.5, upper: 0.5 });
  }
  const from = [0.25, 0.25, 3, ...face], to = [0.25, 0.25, 1, ...face];
  const third = limber.vertexFaceImpact([0.25, 0.25, 1, ...face], [0.25, 0.25, -2, ...face]);
  assert.ok(third.lower <= 1 / 3 && third.upper >= 1 / 3 && third.upper - third.lower <= 2 ** -53);
  const rough = limber.vertexFaceImpact(from, [0.25, 0.25, -4, ...face], { timeError: 0.125 });
  assert.ok(rough.lower <= 3 / 7 && rough.upper >= 3 / 7 && rough.upper - rough.lower <= 0.125);
  isNear(limber.vertexFaceImpact(from, to, { minSeparation: 2 }).upper, 0.5, 1e-12);
  assert.equal(limber.vertexFaceImpact(from, to, { minSeparation: 0.5 }).status, "clear");
  assert.equal(limber.vertexFaceImpact(from, to, { minSeparation: 3.5 }).status, "initialContact");
});

test("two edges touch at the time that is known", () => {
  const across = [0, -1, 0, 0, 1, 0], along = (x, z) => [x - 1, 0, z, x + 1, 0, z];
  const ask = (from, to, options) => limber.edgeEdgeImpact([...from, ...across], [...to, ...across], options);
  assert.deepEqual(ask(along(0, 1), along(0, -3)), { status: "contact", lower: 0.25, upper: 0.25 });
  assert.deepEqual(ask(along(3, 1), along(3, -3)), never);
  assert.deepEqual(ask(along(0, 0), along(0, 2)), atOnce);
  assert.deepEqual(ask(along(3, 0), along(1, 0)), { status: "contact", lower: 1, upper: 1 });
  isNear(ask(along(0, 3), along(0, -1), { minSeparation: 1 }).lower, 0.5, 1e-12);
  // A vertex would go through the plane of a face: which points are which matters.
  assert.notEqual(limber.vertexFaceImpact([...along(0, 1), ...across], [...along(0, -3), ...across]).status, "contact");
});

test("elements that are none are refused", () => {
  for (const impact of [limber.vertexFaceImpact, limber.edgeEdgeImpact]) {
    refuses(() => impact(face, [...face, 0, 0, 1]), "sizeMismatch", "start has 3 points, not 4");
    refuses(() => impact([...face, 0, 0, 1], []), "sizeMismatch", "end has 0 points, not 4");
    refuses(() => impact([0, 0], corners), "sizeMismatch", "start has 2 numbers");
    refuses(() => impact(corners, "corners"), "invalidArgument", "end is no");
    refuses(() => impact(corners), "invalidArgument", "end is no");
    for (const bad of [NaN, Infinity, 1e300]) {
      refuses(() => impact(corners, changed(corners, 5, bad)), "invalidArgument", "coordinate");
    }
    for (const maxTime of [-0.5, 1.5, NaN]) {
      refuses(() => impact(corners, corners, { maxTime }), "invalidArgument", "max_time");
    }
    refuses(() => impact(corners, corners, { timeError: -1 }), "invalidArgument", "time_error");
    refuses(() => impact(corners, corners, { minSeparation: -1 }), "invalidArgument", "min_separation");
    refuses(() => impact(corners, corners, { minSeparation: Infinity }), "invalidArgument", "min_separation");
  }
});

test("a body falls on a plate", () => {
  const floor = plate(), found = limber.timeOfImpact(falling(3, -1), floor);
  assert.deepEqual([found.status, found.lower, found.upper], ["contact", 0.75, 0.75]);
  assert.equal(found.stoppedBy, "nothing");
  assert.ok(["vertexFace", "edgeEdge"].includes(found.elements.kind) && found.stats.primitiveTests > 0);
  assert.deepEqual(found.normal.map((x) => x + 0), [0, 0, -1]);
  assert.deepEqual([found.witness.pointA[2], found.witness.pointB[2]], [0, 0]);
  assert.ok(found.witness.triangleA < 4 && found.witness.triangleB < 2);
  const clear = limber.timeOfImpact(falling(3, 2), floor);
  assert.deepEqual([clear.status, clear.lower, clear.upper], ["clear", Infinity, Infinity]);
  assert.deepEqual([clear.elements, clear.witness, clear.normal], [null, null, [0, 0, 0]]);
  const crossing = limber.timeOfImpact(falling(-0.5, 2), floor);
  assert.deepEqual([crossing.status, crossing.upper, crossing.elements], ["initialContact", 0, null]);
  isNear(crossing.witness.pointA[2], 0, 1e-12);
  // What crosses may go on. An edge is 0.4 above the plate's diagonal, at (0.2, 0.2).
  const down = limber.timeOfImpact(falling(-0.5, -1.5), floor, { ignoreCrossings: true });
  assert.deepEqual([down.status, down.elements.kind], ["contact", "edgeEdge"]);
  isNear(down.upper, 0.4, 1e-15);
  const apart = limber.timeOfImpact(falling(3, -1), floor, { minSeparation: 1, maxTime: 0.9 });
  isNear(apart.upper, 0.5, 1e-12);
  assert.equal(limber.timeOfImpact(falling(3, -1), floor, { maxTime: 0.7 }).status, "clear");
  const any = limber.timeOfImpact(falling(3, -1), floor, { anyContact: true });
  assert.ok(any.status === "contact" && any.lower <= 0.75 && any.upper >= 0.75);
  const rough = limber.timeOfImpact(falling(3, -1.7), floor, { timeError: 2 ** -7 });
  assert.ok(rough.lower <= 3 / 4.7 && rough.upper >= 3 / 4.7 && rough.upper - rough.lower <= 2 ** -7);
});

test("a model may start nearer than the separation", () => {
  const rises = falling(0.3, 3), floor = plate();
  assert.equal(limber.timeOfImpact(rises, floor, { minSeparation: 0.5 }).status, "initialContact");
  assert.equal(limber.timeOfImpact(rises, floor, { minSeparation: 0.5, separationFraction: 0.5 }).status, "clear");
  assert.ok(limber.impacts(rises, floor, { minSeparation: 0.5 }).count > 0);
  assert.equal(limber.impacts(rises, floor, { minSeparation: 0.5, separationFraction: 0.5 }).count, 0);
});

test("a budget that is spent leaves bounds", () => {
  const none = limber.timeOfImpact(falling(3, -1), plate(), { budget: { maxSteps: 0 } });
  assert.deepEqual([none.status, none.stoppedBy], ["undecided", "maxSteps"]);
  assert.ok(none.lower <= 0.75 && none.upper >= 0.75);
  const late = limber.selfTimeOfImpact(moving(...grid(40)), { budget: { deadline: performance.now() - 1 } });
  assert.deepEqual([late.status, late.stoppedBy, late.elements], ["undecided", "deadline", null]);
  for (const budget of [{ deadline: NaN }, { maxSteps: -1 }]) {
    refuses(() => limber.timeOfImpact(plate(), plate(), { budget }), "invalidArgument", "budget");
  }
});

/** Whole numbers below `bound`, from a seed. */
function wholeNumbers(seed) {
  let state = seed;
  return (bound) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * bound);
  };
}

test("impacts are those of all pairs of elements", () => {
  const below = wholeNumbers(3), count = 24;
  const places = (size) => Array.from({ length: 9 * count }, (_, i) => below(size) + (i % 9 < 3 ? 0 : below(3) / 2));
  const triangles = Array.from({ length: 3 * count }, (_, i) => i);
  let contacts = 0, initial = 0;
  for (let round = 0; round < 6; ++round) {
    const startA = places(8), endA = places(8), startB = places(8), endB = places(8);
    const a = moving(startA, triangles, endA), b = moving(startB, triangles, endB);
    const edgesA = a.model.edges(), edgesB = b.model.edges();
    const touching = (firstStart, firstEnd, ends, secondStart, secondEnd, others, isSelf) => {
      const at = (from, v) => from.slice(3 * v, 3 * v + 3);
      const all = new Map();
      const add = (kind, i, j, ids, impact) => {
        if (isSelf && new Set(ids).size < 4) return;
        if (impact.status !== "clear") all.set(`${kind} ${i} ${j}`, impact);
      };
      for (let i = 0; i < 3 * count; ++i) {
        for (let j = 0; j < count; ++j) {
          const corner = [3 * j, 3 * j + 1, 3 * j + 2];
          const points = (one, other) => [...at(one, i), ...corner.flatMap((v) => at(other, v))];
          add("vertexFace", i, j, [i, ...corner],
            limber.vertexFaceImpact(points(firstStart, secondStart), points(firstEnd, secondEnd)));
          if (isSelf) continue;
          add("faceVertex", j, i, [],
            limber.vertexFaceImpact(points(secondStart, firstStart), points(secondEnd, firstEnd)));
        }
      }
      for (let i = 0; i < ends.length / 2; ++i) {
        for (let j = isSelf ? i + 1 : 0; j < others.length / 2; ++j) {
          const mine = [ends[2 * i], ends[2 * i + 1]], yours = [others[2 * j], others[2 * j + 1]];
          const points = (one, other) => [...mine.flatMap((v) => at(one, v)), ...yours.flatMap((v) => at(other, v))];
          add("edgeEdge", i, j, [...mine, ...yours],
            limber.edgeEdgeImpact(points(firstStart, secondStart), points(firstEnd, secondEnd)));
        }
      }
      return all;
    };
    const both = touching(startA, endA, edgesA, startB, endB, edgesB, false);
    const one = touching(startA, endA, edgesA, startA, endA, edgesA, true);
    for (const [all, found, first] of [
      [both, limber.impacts(a, b), limber.timeOfImpact(a, b, { ignoreCrossings: true })],
      [one, limber.selfImpacts(a), limber.selfTimeOfImpact(a, { ignoreCrossings: true })],
    ]) {
      assert.ok(found.isComplete && found.count === all.size && all.size > 100, `${found.count} of ${all.size}`);
      for (const { elements: { kind, a: i, b: j }, time: impact } of found) {
        assert.deepEqual(impact, all.get(`${kind} ${i} ${j}`), `${kind} ${i} ${j}`);
        impact.status === "contact" ? ++contacts : ++initial;
      }
      assert.equal(first.lower, Math.min(...found.lowers));
      assert.ok(all.get(`${first.elements.kind} ${first.elements.a} ${first.elements.b}`).lower <= first.upper);
    }
  }
  assert.ok(contacts > 1000 && initial > 100, `${contacts} contacts, ${initial} at the start`);
});

test("impacts are arrays, and records", () => {
  const a = falling(3, -1), floor = plate(), all = limber.impacts(a, floor);
  assert.equal(all.count, [...all].length);
  assert.equal([...all].filter(({ elements }) => elements.kind === "vertexFace").length >= 4, true);
  assert.ok(all.stats.primitiveTests >= all.count);
  const some = limber.impacts(a, floor, { maxCount: 2 });
  assert.deepEqual([some.count, some.isComplete, all.isComplete], [2, false, true]);
  assert.deepEqual(some.at(1), all.at(1));
  const kind = limber.elementPairKinds[all.kinds[1]], status = limber.impactStatuses[all.statuses[1]];
  assert.deepEqual(all.at(1), {
    elements: { kind, a: all.elementsA[1], b: all.elementsB[1] },
    time: { status, lower: all.lowers[1], upper: all.uppers[1] },
  });
  assert.equal(limber.impacts(a, floor, { maxTime: 0.5 }).count, 0);
  for (const i of [-1, all.count, 0.5, NaN]) refuses(() => all.at(i), "invalidArgument", "impact");
});

test("a model folds onto itself", () => {
  const book = [0, 0, 0, 0, 1, 0, 1, 0.25, 0, -1, 0.25, 0], end = changed(book, 9, 0.5);
  const a = moving(book, [0, 1, 2, 1, 0, 3], end);
  const found = limber.selfTimeOfImpact(a);
  assert.equal(found.status, "contact");
  isNear(found.upper, 2 / 3, 2 ** -52);
  assert.deepEqual(found.elements, { kind: "vertexFace", a: 3, b: 0 });
  assert.ok(limber.selfImpacts(a).count >= 1);
  assert.deepEqual([...a.model.edges()], [0, 1, 0, 2, 0, 3, 1, 2, 1, 3]);
});

test("a motion ends when the model changes", () => {
  const model = tetrahedron(), a = new limber.MovingModel(model), floor = plate();
  assert.equal(a.model, model);
  refuses(() => limber.selfTimeOfImpact(a), "invalidArgument", "motion");
  a.setMotion(Float32Array.from(corners), { startPose: above(1), endPose: null });
  const found = () => limber.timeOfImpact(a, floor).upper;
  assert.equal(found(), 1);
  // What is refused leaves the motion as it was.
  refuses(() => a.setMotion(corners.slice(3)), "sizeMismatch", "3 positions for 4 vertices");
  assert.throws(() => a.setMotion(changed(corners, 7, NaN)), { code: "nonFinite", where: 2 });
  assert.throws(() => a.setMotion(changed(corners, 0, 1e300)), { code: "tooLarge", where: 0 });
  refuses(() => a.setMotion(corners, { startPose: Array(16).fill(1) }), "notRigid", "startPose");
  refuses(() => a.setMotion(corners, { endPose: { translation: [0, NaN, 0] } }), "nonFinite", "endPose");
  refuses(() => a.setMotion(corners, { endPose: 5 }), "invalidArgument", "endPose");
  refuses(() => a.setMotion(corners, { pose: null }), "invalidArgument", "startPose, endPose");
  refuses(() => a.setMotion(), "invalidArgument", "endPositions");
  assert.equal(found(), 1);
  model.moveVertices([3], [0, 0, 2]);
  refuses(() => a.setMotion(corners), "invalidArgument", "commit");
  model.commit();
  refuses(() => found(), "invalidArgument", "motion");
  refuses(() => limber.impacts(a, floor), "invalidArgument", "motion");
  a.setMotion(corners);
  assert.equal(limber.selfTimeOfImpact(a).status, "clear");
});

test("options of moving models are checked", () => {
  const a = plate(), b = falling(3, -1);
  const queries = [(o) => limber.timeOfImpact(a, b, o), (o) => limber.selfTimeOfImpact(a, o),
    (o) => limber.impacts(a, b, o), (o) => limber.selfImpacts(a, o)];
  for (const query of queries) {
    refuses(() => query({ maxTime: 2 }), "invalidArgument", "max_time");
    refuses(() => query({ timeError: NaN }), "invalidArgument", "time_error");
    refuses(() => query({ minSeparation: -1 }), "invalidArgument", "min_separation");
    for (const separationFraction of [-0.1, 1]) {
      refuses(() => query({ separationFraction }), "invalidArgument", "separation_fraction");
    }
  }
});

// --- rigid bodies ---

test("bodies go along a path", () => {
  const body = tetrahedron(), floor = new limber.Model(plateVertices, plateFaces), cache = new limber.QueryCache();
  const motionA = new limber.RigidMotion(above(3), above(-1));
  const found = limber.timeOfImpact(body, floor, { motionA, distanceError: 1e-6 });
  assert.equal(found.status, "contact");
  assert.ok(found.time <= 0.75 && found.time >= 0.75 - 1e-6 && found.distanceCount < 40);
  assert.equal(found.stoppedBy, "nothing");
  isNear(found.witness.pointA[2], 0, 2e-6);
  assert.deepEqual(found.witness.pointB[2], 0);
  isNear(limber.timeOfImpact(body, floor, { motionA, minSeparation: 1, cache }).time, 0.5, 1e-5);
  const swapped = limber.timeOfImpact(floor, body, { motionB: motionA, distanceError: 1e-6 });
  assert.equal(swapped.time, found.time);
  const clear = limber.timeOfImpact(body, floor, { motionA, maxTime: 0.5 });
  assert.deepEqual([clear.status, clear.time, clear.witness], ["clear", Infinity, null]);
  assert.equal(limber.timeOfImpact(body, floor).status, "initialContact");
  const few = limber.timeOfImpact(body, floor, { motionA, minSeparation: 0.01, budget: { maxSteps: 1 } });
  assert.deepEqual([few.status, few.stoppedBy], ["undecided", "maxSteps"]);
  assert.ok(few.time < 0.75);
  const nearest = limber.minDistance(body, floor, { motionA, maxTime: 0.25, distanceError: 1e-5, cache });
  assert.equal(nearest.time, 0.25);
  isNear(nearest.upper, 2, 1e-12);
  assert.ok(nearest.lower <= 2 && nearest.upper - nearest.lower < 1e-5);
  assert.equal(limber.minDistance(body, floor, { motionA }).upper, 0);
});

test("bodies turn", () => {
  // A blade along x turns by 90 degrees about z; its tip, 2 away, gets to the wall y = 1 at 30 degrees.
  const blade = new limber.Model([0, 0, 0, 2, 0, 0, 1, 0, 0.1], [0, 1, 2]);
  const wall = new limber.Model([-9, 1, -9, 9, 1, -9, 0, 1, 9], [0, 1, 2]);
  const motionA = new limber.RigidMotion(null, { quaternion: [0, 0, Math.SQRT1_2, Math.SQRT1_2] });
  const found = limber.timeOfImpact(blade, wall, { motionA, distanceError: 1e-9 });
  assert.equal(found.status, "contact");
  assert.ok(found.time <= 1 / 3 + 1e-12 && found.time > 1 / 3 - 1e-8, `${found.time}`);
  assert.deepEqual(limber.distance(blade, wall, { poseA: motionA.at(found.time), maxDistance: 2e-9 }).status, "exact");
  const nearest = limber.minDistance(blade, wall, { motionA, maxTime: 0.25, distanceError: 1e-9 });
  isNear(nearest.upper, 1 - 2 * Math.sin(Math.PI / 8), 1e-8);
  assert.equal(nearest.time, 0.25);
  const widths = [undefined, 0].map((distanceError) => {
    const { lower, upper } = limber.minDistance(blade, wall, { motionA, maxTime: 0.25, distanceError });
    return upper - lower;
  });
  assert.ok(widths[0] > 1e-4 && widths[1] < 1e-11, widths.join(" "));
});

test("motions give poses", () => {
  const half = Math.SQRT1_2, quarter = { quaternion: [0, 0, half, half], translation: [2, 0, 0] };
  const turns = new limber.RigidMotion(null, quarter);
  assert.deepEqual(turns.at(0), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  turns.at(1).forEach((x, i) => isNear(x, [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1][i], 1e-15, i));
  const middle = [half, half, 0, 0, -half, half, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1];
  turns.at(0.5).forEach((x, i) => isNear(x, middle[i], 1e-15, i));
  const screw = limber.RigidMotion.screw(null, quarter).at(0.5);  // about the vertical line through (1, 1)
  [1, 1 - Math.SQRT2, 0].forEach((x, i) => isNear(screw[12 + i], x, 1e-15, i));
  // The center goes straight.
  const about = new limber.RigidMotion(null, quarter, { x: 1, y: 0, z: 0 }).at(0.5);
  [half + about[12], half + about[13]].forEach((x, i) => isNear(x, [1.5, 0.5][i], 1e-15, i));
  const stands = new limber.RigidMotion(quarter);
  assert.deepEqual(stands.at(0.5), stands.at(1));
  assert.equal(stands.at(0.5)[12], 2);
  for (const time of [-0.5, 1.5, NaN]) refuses(() => turns.at(time), "invalidArgument", "time");
});

test("motions that are none are refused, and what paths do not take", () => {
  const a = tetrahedron(), b = tetrahedron(), motion = new limber.RigidMotion();
  refuses(() => new limber.RigidMotion(Array(16).fill(1)), "notRigid", "start");
  refuses(() => new limber.RigidMotion(null, { quaternion: [0, 0, 0, 0] }), "nonFinite", "end");
  refuses(() => limber.RigidMotion.screw(null, Array(16).fill(1)), "notRigid", "end");
  refuses(() => new limber.RigidMotion(null, null, [0, 0]), "invalidArgument", "center");
  refuses(() => new limber.RigidMotion(null, null, [0, 0, NaN]), "invalidArgument", "center");
  for (const query of [limber.timeOfImpact, limber.minDistance]) {
    for (const wrong of [null, {}, { translation: [0, 0, 1] }, a, Object.create(limber.RigidMotion.prototype)]) {
      refuses(() => query(a, b, { motionA: wrong }), "invalidArgument", "motionA");
      refuses(() => query(a, b, { motionA: motion, motionB: wrong }), "invalidArgument", "motionB");
    }
    refuses(() => query(a, b, { maxTime: 2 }), "invalidArgument", "max_time");
    refuses(() => query(a, b, { distanceError: -1 }), "invalidArgument", "distance_error");
    refuses(() => query(a, b, { budget: { maxSteps: -1 } }), "invalidArgument", "budget");
    b.moveAll(corners.map((x) => 2 * x));
    refuses(() => query(a, b, {}), "invalidArgument", "commit");
    b.commit();
  }
  refuses(() => limber.timeOfImpact(a, b, { minSeparation: -1 }), "invalidArgument", "min_separation");
});

test("what is no moving model is refused, and what has been disposed of", () => {
  const model = tetrahedron(), a = new limber.MovingModel(model), b = plate(), motion = new limber.RigidMotion();
  a.setMotion(corners);
  for (const wrong of [undefined, null, {}, 5, motion, Object.create(limber.MovingModel.prototype)]) {
    refuses(() => limber.timeOfImpact(wrong, a), "invalidArgument", "a is");
    refuses(() => limber.timeOfImpact(a, wrong), "invalidArgument", "b is");
    refuses(() => limber.timeOfImpact(model, wrong), "invalidArgument", "b is");
    refuses(() => limber.impacts(a, wrong), "invalidArgument", "b is");
    refuses(() => limber.selfTimeOfImpact(wrong), "invalidArgument", "model is");
    refuses(() => limber.selfImpacts(wrong), "invalidArgument", "model is");
    refuses(() => new limber.MovingModel(wrong), "invalidArgument", "model is no Model");
    refuses(() => limber.minDistance(model, wrong), "invalidArgument", "b is no Model");
  }
  refuses(() => limber.timeOfImpact(a, model), "invalidArgument", "b is no MovingModel");
  refuses(() => limber.timeOfImpact(model, a), "invalidArgument", "b is no Model");
  motion.dispose();
  refuses(() => motion.at(0), "disposed", "motion");
  refuses(() => limber.timeOfImpact(model, model, { motionB: motion }), "disposed", "motionB");
  model.dispose();
  for (const use of [() => limber.timeOfImpact(b, a), () => limber.impacts(a, b), () => limber.selfTimeOfImpact(a),
    () => a.setMotion(corners), () => model.edges(), () => new limber.MovingModel(model)]) {
    refuses(use, "disposed", "model");
  }
  a.dispose();
  a.dispose();
  assert.ok(a.isDisposed && !b.isDisposed);
  refuses(() => limber.timeOfImpact(a, b), "disposed", "a has been");
  refuses(() => a.setMotion(corners), "disposed", "moving model");
});
