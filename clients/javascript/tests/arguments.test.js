// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Arguments that are not what the comments say, and arguments that run code of the caller while they are read.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { corners, faces, grid, refuses, row, tetrahedron } from "./support.js";

const { Shape } = limber;
const notNumbers = [null, "7", true, [1], 7n, {}, Symbol("7"), Object.create(null), undefined];
const scaled = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1];

before(() => limber.init());

/** A moving model that stays where its model is. */
function staying(model) {
  const moving = new limber.MovingModel(model);
  moving.setMotion(model.vertices());
  return moving;
}

/** Everything that takes options, of one model, and the names of these. */
function callsWithOptions(a) {
  const surface = new limber.ClosedSurface(a), moving = staying(a), scene = row(2, a);
  const errors = ["relativeError", "absoluteError", "maxDistance"], poses = ["poseA", "poseB"];
  const impacts = ["maxTime", "timeError", "minSeparation", "separationFraction", "ignoreCrossings", "anyContact",
    "budget"];
  return [
    [(o) => limber.distance(a, a, o), [...poses, ...errors, "budget", "cache"]],
    [(o) => limber.collide(a, a, o), [...poses, "budget", "cache"]],
    [(o) => limber.within(a, a, 1, o), [...poses, "budget", "cache"]],
    [(o) => limber.contacts(a, a, 1, o), [...poses, "maxCount"]],
    [(o) => limber.selfCollide(a, o), ["filter", "cache"]],
    [(o) => limber.selfDistance(a, o), [...errors, "filter", "cache"]],
    [(o) => limber.selfContacts(a, 1, o), ["filter", "maxCount"]],
    [(o) => limber.closestPoint(a, [0, 0, 0], o), ["pose", "maxDistance"]],
    [(o) => limber.closestPointMany(a, [0, 0, 0], o), ["pose", "maxDistance"]],
    [(o) => surface.signedDistance([0, 0, 0], o), ["pose", "maxDistance"]],
    [(o) => surface.contains([0, 0, 0], o), ["pose"]],
    [(o) => moving.setMotion(corners, o), ["startPose", "endPose"]],
    [(o) => limber.timeOfImpact(moving, moving, o), impacts],
    [(o) => limber.selfTimeOfImpact(moving, o), impacts],
    [(o) => limber.timeOfImpact(a, a, o),
      ["motionA", "motionB", "maxTime", "minSeparation", "distanceError", "budget", "cache"]],
    [(o) => scene.collide([0, 1], o), ["budget"]],
    [(o) => scene.within([0, 1], 1, o), ["budget"]],
    [(o) => scene.distance([0, 1], o), [...errors, "budget"]],
    [(o) => scene.closestObjects(o), [...errors, "ignoredPairs", "budget"]],
  ];
}

test("options that do not exist are refused with those that do", () => {
  const a = tetrahedron();
  for (const [call, names] of [
    ...callsWithOptions(a),
    [(o) => new limber.Model(corners, faces, o), ["motionMargin", "rebuildPolicy"]],
    [(budget) => limber.distance(a, a, { budget }), ["deadline", "maxSteps"]],
    [(poseB) => limber.distance(a, a, { poseB }), ["quaternion", "rotation", "translation"]],
  ]) {
    refuses(() => call({ poseC: undefined }), "invalidArgument", '"poseC"', `there are ${names.join(", ")}`);
    for (const options of [5, "options", true, () => {}]) refuses(() => call(options), "invalidArgument");
  }
  refuses(() => limber.distance(a, a, null), "invalidArgument", "options");
});

test("options are of their kind, and in their range", () => {
  const a = tetrahedron();
  const places = ["poseA", "poseB", "pose", "startPose", "endPose"], flags = ["ignoreCrossings", "anyContact"];
  for (const [call, names] of callsWithOptions(a)) {
    for (const name of names) {
      for (const wrong of notNumbers) {
        if (wrong === undefined || (wrong === null && places.includes(name))) continue;  // not given
        if ((wrong === true && flags.includes(name)) || (name === "budget" && typeof wrong === "object")) continue;
        if (Array.isArray(wrong) && name === "ignoredPairs") continue;
        refuses(() => call({ [name]: wrong }), "invalidArgument", name);
      }
      if (places.includes(name)) refuses(() => call({ [name]: scaled }), "notRigid", `${name}: `);
      if (name === "budget") {
        for (const wrong of [NaN, null, "7"]) {
          for (const limit of ["deadline", "maxSteps"]) {
            refuses(() => call({ budget: { [limit]: wrong } }), "invalidArgument", `budget.${limit}`);
          }
        }
      }
      if (/Error|Distance|Time|Separation|Fraction/.test(name)) {
        for (const wrong of [-1, NaN]) refuses(() => call({ [name]: wrong }), "invalidArgument", "_");
      }
    }
  }
  refuses(() => limber.collide(a, a, { budget: { maxSteps: -1 } }), "invalidArgument", "budget.maxSteps");
  refuses(() => limber.timeOfImpact(a, a, { maxTime: 2 }), "invalidArgument", "max_time");
  for (const motionMargin of [-1, Infinity, "auto", ...notNumbers.slice(0, -1)]) {
    refuses(() => new limber.Model(corners, faces, { motionMargin }), "invalidArgument", "motionMargin");
  }
  refuses(() => new limber.Model(corners, faces, { rebuildPolicy: "onWorker" }), "invalidArgument", "rebuildPolicy");
});

test("meshes that are none are refused with code and place", () => {
  refuses(() => new limber.Model([], []), "emptyMesh");
  refuses(() => new limber.Model([0, 0], [0, 1, 2]), "sizeMismatch", "vertices has 2 numbers");
  refuses(() => new limber.Model(corners, [0, 1]), "sizeMismatch", "faces has 2 ids");
  refuses(() => new limber.Model(corners, [0, 1, 4]), "indexOutOfRange", "vertex 4");
  refuses(() => new limber.Model(corners, Int32Array.of(0, -1, 1)), "indexOutOfRange", "faces[1] is -1");
  refuses(() => new limber.Model(corners, [0, 1, 1.5]), "indexOutOfRange", "faces[2] is 1.5");
  refuses(() => new limber.Model([0, 0, 0, 1, 0, 1e300, 0, 1, 0], [0, 1, 2]), "tooLarge");
  for (const wrong of [new Uint8Array(9), "abc", null, undefined]) {
    refuses(() => new limber.Model(wrong, [0, 1, 2]), "invalidArgument", "vertices");
    refuses(() => new limber.Model(corners, wrong), "invalidArgument", "faces");
  }
  const infinite = { name: "LimberError", code: "nonFinite", where: 1 };
  assert.throws(() => new limber.Model([0, 0, 0, 1, 0, Infinity, 0, 1, 0], [0, 1, 2]), infinite);
});

test("coordinates and other arguments are numbers", () => {
  const a = tetrahedron(), surface = new limber.ClosedSurface(a), moving = staying(a), scene = row(2);
  for (const wrong of notNumbers) {
    refuses(() => new limber.Model([0, 0, 0, 1, 0, wrong], [0, 1, 2]), "invalidArgument", "vertices[5]", "no number");
    refuses(() => a.moveAll([...corners.slice(0, 11), wrong]), "invalidArgument", "positions[11]");
    refuses(() => a.moveVertices([1], [0, wrong, 0]), "invalidArgument", "positions[1]");
    refuses(() => moving.setMotion([...corners.slice(0, 11), wrong]), "invalidArgument", "endPositions[11]");
    refuses(() => limber.closestPointMany(a, [0, wrong, 0]), "invalidArgument", "points[1]");
    refuses(() => Shape.convexHull([0, wrong, 0]), "invalidArgument", "points[1]");
    for (const point of [[0, wrong, 0], { x: wrong, y: 0, z: 0 }, wrong]) {
      refuses(() => limber.closestPoint(a, point), "invalidArgument", "point");
      refuses(() => surface.contains(point), "invalidArgument", "point");
      refuses(() => surface.signedDistance(point), "invalidArgument", "point");
      refuses(() => Shape.capsule([0, 0, 0], point, 1), "invalidArgument", "end");
      refuses(() => Shape.box(point), "invalidArgument", "halfExtents");
      if (point === undefined) continue;
      refuses(() => new limber.RigidMotion(null, null, point), "invalidArgument", "center");
      refuses(() => limber.distance(a, a, { poseA: { translation: point } }), "invalidArgument", "poseA.translation");
    }
    refuses(() => new limber.Model(corners, [0, 1, wrong]), "indexOutOfRange", "faces[2]");
    refuses(() => a.moveVertices([wrong], [0, 0, 0]), "indexOutOfRange", "ids[0]");
    const matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, wrong, 1];
    for (const poseA of [matrix, { elements: matrix }, { quaternion: [0, 0, wrong, 1] },
      { quaternion: { x: 0, y: 0, z: 0, w: wrong } }, { rotation: [1, 0, 0, 0, 1, 0, 0, wrong, 1] }]) {
      refuses(() => limber.distance(a, a, { poseA }), "invalidArgument", "poseA");
    }
  }
  for (const wrong of [-1, NaN, ...notNumbers]) {
    refuses(() => limber.within(a, a, wrong), "invalidArgument", "");
    refuses(() => limber.contacts(a, a, wrong), "invalidArgument", "margin");
    refuses(() => limber.selfContacts(a, wrong), "invalidArgument", "margin");
    refuses(() => scene.candidatePairs(wrong), "invalidArgument", "margin");
    refuses(() => scene.within([0, 1], wrong), "invalidArgument");
    refuses(() => new limber.NeighborRings(a, wrong), "invalidArgument", "maxEdges");
    refuses(() => new limber.RigidMotion().at(wrong), "invalidArgument", "time");
    refuses(() => Shape.sphere(wrong), "invalidArgument", "radius");
  }
  refuses(() => new limber.Model([0, 0, 0, 1, 0, 0, 0, , 0], [0, 1, 2]), "invalidArgument", "vertices[7]");
  refuses(() => a.moveVertices([4], [0, 0, 0]), "indexOutOfRange", "4");
  refuses(() => a.moveVertices([0, 1], [0, 0, 0]), "sizeMismatch");
  refuses(() => a.moveAll([0, 0, 0]), "sizeMismatch");
  refuses(() => limber.closestPoint(a, [0, 0, NaN]), "invalidArgument", "point");
  refuses(() => limber.closestPointMany(a, [0, 0]), "sizeMismatch", "points");
  refuses(() => Shape.box([1, -1, 1]), "invalidArgument", "half extents");
  refuses(() => Shape.convexHull([]), "invalidArgument", "there must be a point");
  assert.equal(limber.collide(a, a).answer, "yes", "what is refused moves nothing");
});

test("what is no pose is refused, naming the argument", () => {
  const a = tetrahedron(), mirrored = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  refuses(() => limber.distance(a, a, { poseB: { elements: mirrored } }), "notRigid", "poseB");
  refuses(() => limber.distance(a, a, { poseB: { rotation: [2, 0, 0, 0, 1, 0, 0, 0, 1] } }), "notRigid", "poseB");
  refuses(() => limber.distance(a, a, { poseB: { translation: [0, NaN, 0] } }), "nonFinite", "poseB");
  refuses(() => limber.distance(a, a, { poseB: { quaternion: [0, 0, 0, 0] } }), "nonFinite", "poseB");
  refuses(() => limber.distance(a, a, { poseA: { rotation: scaled } }), "invalidArgument", "poseA.rotation");
  refuses(() => new limber.Scene().add(a, scaled), "notRigid", "pose: ");
  refuses(() => new limber.RigidMotion(scaled), "notRigid", "start");
  refuses(() => new limber.RigidMotion(null, scaled), "notRigid", "end");
  const both = { quaternion: [0, 0, 0, 1], rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1] };
  for (const pose of [[1, 2, 3], {}, both]) refuses(() => new limber.RigidMotion(pose), "invalidArgument", "start");
});

test("scenes refuse wrong ids and pairs, and are as before", () => {
  const scene = row(3);
  for (const id of [7, -1, 0.5, "1", undefined, NaN]) {
    for (const call of [() => scene.remove(id), () => scene.setPose(id, null)]) refuses(call, "invalidArgument");
  }
  refuses(() => scene.add({}), "invalidArgument", "model");
  refuses(() => scene.setPose(0, scaled), "notRigid", "pose: ");
  refuses(() => scene.collide([0, 1, 2]), "sizeMismatch", "pairs");
  refuses(() => scene.collide([0, 7]), "invalidArgument", "pair");
  refuses(() => scene.closestObjects({ ignoredPairs: [0] }), "sizeMismatch", "ignoredPairs");
  for (const ignoredPairs of [[0, 0], [0, 9]]) refuses(() => scene.closestObjects({ ignoredPairs }), "invalidArgument");
  assert.ok(scene.size === 3 && scene.closestObjects().result.upper === 0);
});

test("what is not of this package is refused", () => {
  const a = tetrahedron(), cache = new limber.QueryCache(), ball = Shape.sphere(1), moving = staying(a);
  for (const wrong of [undefined, null, {}, 5, cache, Object.create(limber.Model.prototype)]) {
    refuses(() => limber.distance(a, wrong), "invalidArgument", "b is");
    refuses(() => limber.collide(wrong, a), "invalidArgument", "a is");
    refuses(() => limber.selfCollide(wrong), "invalidArgument", "model is");
    refuses(() => limber.timeOfImpact(wrong, moving), "invalidArgument", "a is");
    refuses(() => limber.timeOfImpact(moving, wrong), "invalidArgument", "b is no MovingModel");
    refuses(() => limber.timeOfImpact(a, wrong), "invalidArgument", "b is");
    refuses(() => limber.selfTimeOfImpact(wrong), "invalidArgument", "model is");
  }
  for (const Kind of [limber.ClosedSurface, limber.MovingModel, limber.NeighborRings]) {
    refuses(() => new Kind(ball, 0), "invalidArgument", "no Model");
  }
  refuses(() => limber.closestPoint(ball, [0, 0, 0]), "invalidArgument", "no Model");
  refuses(() => limber.selfCollide(ball), "invalidArgument", "no Model");
  refuses(() => new Shape(), "invalidArgument", "Shape.sphere()");
  refuses(() => new limber.ClosedSurface(new limber.Model(...grid(3))), "notClosed", "edge");
});

test("what has been disposed of is refused, and disposing again does nothing", () => {
  const a = tetrahedron(), b = tetrahedron(), cache = new limber.QueryCache(), rings = new limber.NeighborRings(b, 0);
  const motionA = new limber.RigidMotion(), ball = Shape.sphere(1), scene = row(2, a), other = new limber.Scene();
  const calls = callsWithOptions(a);
  for (const owner of [a, cache, rings, motionA, ball, other]) {
    assert.ok(!owner.isDisposed);
    owner.dispose();
    owner.dispose();
    assert.ok(owner.isDisposed);
  }
  for (const use of [
    ...calls.map(([call]) => () => call({})),
    () => limber.distance(b, ball), () => limber.distance(b, b, { cache }),
    () => limber.selfContacts(b, 1, { filter: rings }), () => a.commit(), () => a.moveAll(corners), () => a.vertices(),
    () => cache.clear(), () => motionA.at(0), () => limber.timeOfImpact(b, b, { motionA }),
    () => other.size, () => scene.commit(), () => scene.add(b), () => scene.candidatePairs(1),
  ]) {
    refuses(use, "disposed");
  }
  scene.remove(0), scene.remove(1);
  scene.commit();
});

// --- arguments that run code of the caller ---

/** An object whose properties run `body` before they give their values. */
function reading(values, body) {
  const object = {};
  for (const [name, value] of Object.entries(values)) {
    Object.defineProperty(object, name, { enumerable: true, get: () => (body(), value) });
  }
  return object;
}

/** An array whose last number runs `body` before it is given. */
function arrayReading(values, body) {
  const array = [...values], last = values.length - 1;
  Object.defineProperty(array, last, { enumerable: true, get: () => (body(), values[last]) });
  return array;
}

test("what is read may call the library before anything is written for the call", () => {
  const far = corners.map((x) => x + 100), farAway = { translation: [100, 200, 300] };
  const b = new limber.Model(corners.map((x, i) => (i % 3 === 2 ? x + 4 : x)), faces);
  const disturb = () => {
    const other = new limber.Model(far, faces);
    limber.distance(other, b, { poseA: farAway, poseB: farAway });
    limber.closestPointMany(other, far);
    other.dispose();
  };
  const options = reading({ motionMargin: 0, rebuildPolicy: "off" }, disturb);
  const a = new limber.Model(arrayReading(corners, disturb), arrayReading(faces, disturb), options);
  assert.deepEqual([[...a.vertices()], [...a.edges()]], [corners, [...tetrahedron().edges()]]);
  a.moveVertices(arrayReading([0], disturb), arrayReading([0, 0, 0], disturb));
  a.moveAll(arrayReading(corners, disturb));
  a.commit();
  assert.deepEqual([...a.vertices()], corners);

  const up = [0, 0, 1], translation = arrayReading(up, disturb);
  const matrix = arrayReading([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1], disturb);
  const turn = { rotation: arrayReading([1, 0, 0, 0, 1, 0, 0, 0, 1], disturb), translation: up };
  const place = { quaternion: reading({ x: 0, y: 0, z: 0, w: 1 }, disturb), translation };
  for (const poseA of [reading(place, disturb), matrix, reading(turn, disturb)]) {
    const budget = reading({ maxSteps: 99 }, disturb);
    const given = reading({ poseA, poseB: poseA, relativeError: 0, budget }, disturb);
    assert.equal(limber.distance(a, b, given).upper, 3);
    assert.equal(limber.contacts(a, b, 2, reading({ poseA, maxCount: 100 }, disturb)).at(0).distance, 2);
    const point = reading({ x: 0, y: 0, z: 0 }, disturb), pose = reading({ pose: poseA, maxDistance: 50 }, disturb);
    assert.equal(limber.closestPoint(a, point, pose).closest.distance, 1);
    const surface = new limber.ClosedSurface(a), moving = new limber.MovingModel(a);
    assert.equal(surface.contains(point, { pose: poseA }), false);
    assert.equal(surface.signedDistanceMany(arrayReading([0, 0, 0], disturb), pose).distances[0], 1);
    moving.setMotion(arrayReading(corners, disturb), reading({ startPose: null, endPose: poseA }, disturb));
    const times = reading({ maxTime: 1, minSeparation: 2.5, separationFraction: 0 }, disturb);
    assert.equal(Math.round(1e9 * limber.timeOfImpact(moving, staying(b), times).upper), 5e8);
    const motionA = new limber.RigidMotion(reading({ translation: [0, 0, 0] }, disturb), poseA);
    const path = reading({ motionA, minSeparation: 2.5, distanceError: 1e-9 }, disturb);
    assert.equal(Math.round(1e8 * limber.timeOfImpact(a, b, path).time), 5e7);
  }
});

test("what is read may dispose of the arguments, which is then noticed", () => {
  const disposing = (call) => {
    const a = tetrahedron();
    refuses(() => call(a, () => a.dispose()), "disposed");
  };
  for (const i of callsWithOptions(tetrahedron()).keys()) {
    const names = (calls) => calls[i][1];
    for (const name of names(callsWithOptions(tetrahedron()))) {
      disposing((a, free) => callsWithOptions(a)[i][0](reading({ [name]: undefined }, free)));
    }
  }
  disposing((a, free) => a.moveAll(arrayReading(corners, free)));
  disposing((a, free) => a.moveVertices(arrayReading([0], free), [0, 0, 0]));
  disposing((a, free) => staying(a).setMotion(arrayReading(corners, free)));
  disposing((a, free) => limber.closestPointMany(a, arrayReading([0, 0, 0], free)));
  disposing((a, free) => new limber.ClosedSurface(a).contains(reading({ x: 0, y: 0, z: 0 }, free)));
  disposing((a, free) => new limber.Scene().add(a, { translation: arrayReading([0, 0, 0], free) }));
  disposing((a, free) => row(2, a).distance(arrayReading([0, 1], free)));
});
