// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Arguments that are not what the comments say, and arguments that run code of the caller while they are read.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { corners, faces, refuses, tetrahedron } from "./support.js";

const notNumbers = [null, "7", true, [1], 7n, {}, Symbol("7"), Object.create(null), undefined];

before(() => limber.init());

/** A moving model that stays where its model is. */
function staying(model) {
  const moving = new limber.MovingModel(model);
  moving.setMotion(model.vertices());
  return moving;
}

test("options that do not exist are refused with those that do", () => {
  const a = tetrahedron(), surface = new limber.ClosedSurface(a), moving = staying(a), scene = new limber.Scene();
  const calls = {
    "poseA, poseB, relativeError, absoluteError, maxDistance, budget, cache": [(o) => limber.distance(a, a, o)],
    "poseA, poseB, budget, cache": [(o) => limber.collide(a, a, o), (o) => limber.within(a, a, 1, o)],
    "poseA, poseB, filter, maxCount": [(o) => limber.intersections(a, a, o), (o) => limber.contacts(a, a, 1, o)],
    "poseA, poseB, filter, maxDistance": [(o) => limber.closestPairs(a, a, 1, o)],
    "filter, cache": [(o) => limber.selfCollide(a, o)],
    "relativeError, absoluteError, maxDistance, filter, cache": [(o) => limber.selfDistance(a, o)],
    "filter, maxCount": [(o) => limber.selfIntersections(a, o), (o) => limber.selfContacts(a, 1, o)],
    "filter, maxDistance": [(o) => limber.selfClosestPairs(a, 1, o)],
    "poseA, poseB": [(o) => limber.solidRelation(surface, surface, o)],
    "poseA, poseB, budget": [
      (o) => limber.deepestVertices(surface, surface, o),
      (o) => limber.separatingTranslation(surface, surface, [1, 0, 0], o),
    ],
    "poseA, poseB, relativeError, budget": [(o) => limber.signedDistance(surface, surface, o)],
    "budget, cache": [(o) => scene.collide([], o), (o) => scene.within([], 1, o)],
    "relativeError, absoluteError, maxDistance, budget, cache": [(o) => scene.distance([], o)],
    "relativeError, absoluteError, maxDistance, filter, budget, cache": [(o) => scene.closestObjects(o)],
    "relativeError, absoluteError, maxDistance, filter, budget": [(o) => scene.closestObjectsMany([0], [], o)],
    "maxTime, minSeparation, distanceError, filter, budget": [
      (o) => scene.timeOfImpact(a, new limber.RigidMotion(), o),
    ],
    "filter, budget": [(o) => scene.anyWithin(1, o), (o) => scene.anyWithinMany([0], [], 1, o)],
    "pose, maxDistance": [
      (o) => limber.closestPoint(a, [0, 0, 0], o),
      (o) => limber.closestPointMany(a, [0, 0, 0], o),
      (o) => surface.signedDistance([0, 0, 0], o),
      (o) => surface.signedDistanceMany([0, 0, 0], o),
    ],
    "pose, filter": [(o) => scene.candidates(a, 1, o)],
    "pose": [(o) => surface.contains([0, 0, 0], o)],
    "motionMargin, rebuildPolicy, rebuildBudgetUs, preallocate": [(o) => new limber.Model(corners, faces, o)],
    "maxTime, timeError, minSeparation": [
      (o) => limber.vertexFaceImpact(corners, corners, o),
      (o) => limber.edgeEdgeImpact(corners, corners, o),
    ],
    "maxTime, timeError, minSeparation, separationFraction, ignoreCrossings, anyContact, budget": [
      (o) => limber.timeOfImpact(moving, moving, o),
      (o) => limber.selfTimeOfImpact(moving, o),
    ],
    "maxTime, timeError, minSeparation, separationFraction, maxCount": [
      (o) => limber.impacts(moving, moving, o),
      (o) => limber.selfImpacts(moving, o),
    ],
    "motionA, motionB, maxTime, minSeparation, distanceError, budget, cache": [(o) => limber.timeOfImpact(a, a, o)],
    "motionA, motionB, maxTime, distanceError, budget, cache": [(o) => limber.minDistance(a, a, o)],
    "startPose, endPose": [(o) => moving.setMotion(corners, o)],
    "deadline, maxSteps": [(budget) => limber.distance(a, a, { budget }), (budget) => limber.collide(a, a, { budget })],
    "quaternion, rotation, translation": [(poseB) => limber.distance(a, a, { poseB })],
  };
  for (const [known, functions] of Object.entries(calls)) {
    for (const call of functions) {
      refuses(() => call({ poseC: undefined }), "invalidArgument", '"poseC"', `there are ${known}`);
      for (const options of [5, "options", true]) refuses(() => call(options), "invalidArgument");
    }
  }
  for (const options of [null, () => {}]) {
    refuses(() => limber.distance(a, a, options), "invalidArgument", "options");
    refuses(() => new limber.Model(corners, faces, options), "invalidArgument", "options");
  }
  refuses(() => limber.distance(a, a, { relError: 1 }), "invalidArgument", '"relError"', "relativeError");
  refuses(() => limber.distance(a, a, { poseB: { quaternion: [0, 0, 0, 1], position: [0, 0, 9] } }), "invalidArgument",
    'poseB', '"position"', "translation");
  refuses(() => limber.distance(a, a, { poseB: { quaternion: [0, 0, 0, 1], rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1] } }),
    "invalidArgument", "poseB", "rotation");
});

test("coordinates are numbers", () => {
  const a = tetrahedron(), surface = new limber.ClosedSurface(a), moving = staying(a);
  for (const wrong of notNumbers) {
    const bad = [0, 0, 0, 1, 0, wrong, 0, 1, 0];
    refuses(() => new limber.Model(bad, [0, 1, 2]), "invalidArgument", "vertices[5]", "no number");
    refuses(() => a.moveAll([...corners.slice(0, 11), wrong]), "invalidArgument", "positions[11]");
    refuses(() => a.moveVertices([1], [0, wrong, 0]), "invalidArgument", "positions[1]");
    refuses(() => moving.setMotion([...corners.slice(0, 11), wrong]), "invalidArgument", "endPositions[11]");
    refuses(() => limber.edgeEdgeImpact(corners, [...corners.slice(0, 11), wrong]), "invalidArgument", "end[11]");
    refuses(() => limber.closestPointMany(a, [0, wrong, 0]), "invalidArgument", "points[1]");
    for (const point of [[0, wrong, 0], { x: wrong, y: 0, z: 0 }, wrong]) {
      refuses(() => limber.closestPoint(a, point), "invalidArgument", "point");
      refuses(() => surface.contains(point), "invalidArgument", "point");
      if (point !== undefined) refuses(() => new limber.RigidMotion(null, null, point), "invalidArgument", "center");
      refuses(() => surface.signedDistance(point), "invalidArgument", "point");
      if (point === undefined) continue;
      refuses(() => limber.distance(a, a, { poseA: { translation: point } }), "invalidArgument", "poseA.translation");
    }
    refuses(() => new limber.Model(corners, [0, 1, wrong]), "indexOutOfRange", "faces[2]");
    refuses(() => a.moveVertices([wrong], [0, 0, 0]), "indexOutOfRange", "ids[0]");
  }
  assert.ok(a.isCommitted);
  refuses(() => new limber.Model([0, 0, 0, 1, 0, 0, 0, , 0], [0, 1, 2]), "invalidArgument", "vertices[7]");
  refuses(() => new limber.Model(null, faces), "invalidArgument", "vertices");
  refuses(() => new limber.Model(corners, null), "invalidArgument", "faces");
});

test("numbers of poses and options are numbers", () => {
  const a = tetrahedron(), surface = new limber.ClosedSurface(a), moving = staying(a);
  for (const wrong of notNumbers) {
    const matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, wrong, 1];
    for (const poseA of [matrix, { elements: matrix }, { quaternion: [0, 0, wrong, 1] },
      { quaternion: { x: 0, y: 0, z: 0, w: wrong } }, { rotation: [1, 0, 0, 0, 1, 0, 0, wrong, 1] }]) {
      refuses(() => limber.distance(a, a, { poseA }), "invalidArgument", "poseA");
    }
    refuses(() => limber.orthonormalized([1, 0, 0, 0, 1, 0, 0, wrong, 1]), "invalidArgument", "rotation");
    refuses(() => limber.orthonormalized(wrong), "invalidArgument", "rotation");
    refuses(() => limber.within(a, a, wrong), "invalidArgument", "maxDistance");
    refuses(() => limber.contacts(a, a, wrong), "invalidArgument", "margin");
    refuses(() => limber.selfContacts(a, wrong), "invalidArgument", "margin");
    refuses(() => limber.closestPairs(a, a, wrong), "invalidArgument", "count");
    refuses(() => limber.selfClosestPairs(a, wrong), "invalidArgument", "count");
    refuses(() => new limber.NeighborRings(a, wrong), "invalidArgument", "maxEdges");
    refuses(() => a.nodeSpheres(wrong), "invalidArgument", "level");
    refuses(() => new limber.RigidMotion().at(wrong), "invalidArgument", "time");
    if (wrong === undefined) continue;  // an option that is not given
    for (const name of ["relativeError", "absoluteError", "maxDistance"]) {
      refuses(() => limber.distance(a, a, { [name]: wrong }), "invalidArgument", name);
      refuses(() => limber.selfDistance(a, { [name]: wrong }), "invalidArgument", name);
    }
    for (const name of ["deadline", "maxSteps"]) {
      refuses(() => limber.collide(a, a, { budget: { [name]: wrong } }), "invalidArgument", `budget.${name}`);
    }
    for (const name of ["maxTime", "timeError", "minSeparation"]) {
      refuses(() => limber.vertexFaceImpact(corners, corners, { [name]: wrong }), "invalidArgument", name);
      refuses(() => limber.selfTimeOfImpact(moving, { [name]: wrong }), "invalidArgument", name);
      refuses(() => limber.impacts(moving, moving, { [name]: wrong }), "invalidArgument", name);
    }
    for (const name of ["separationFraction", "maxCount"]) {
      refuses(() => limber.selfImpacts(moving, { [name]: wrong }), "invalidArgument", name);
    }
    for (const name of ["maxTime", "minSeparation", "distanceError"]) {
      refuses(() => limber.timeOfImpact(a, a, { [name]: wrong }), "invalidArgument", name);
    }
    refuses(() => limber.contacts(a, a, 1, { maxCount: wrong }), "invalidArgument", "maxCount");
    refuses(() => limber.selfIntersections(a, { maxCount: wrong }), "invalidArgument", "maxCount");
    refuses(() => limber.closestPoint(a, [0, 0, 0], { maxDistance: wrong }), "invalidArgument", "maxDistance");
    refuses(() => surface.signedDistance([0, 0, 0], { maxDistance: wrong }), "invalidArgument", "maxDistance");
    refuses(() => new limber.Model(corners, faces, { motionMargin: wrong }), "invalidArgument", "motionMargin");
    refuses(() => new limber.Model(corners, faces, { rebuildPolicy: wrong }), "invalidArgument", "rebuildPolicy");
    refuses(() => a.setMotionMargin(wrong), "invalidArgument", "motionMargin");
    if (wrong !== null) refuses(() => limber.distance(a, a, { poseA: wrong }), "invalidArgument", "poseA");
    if (wrong !== true) {
      refuses(() => new limber.Model(corners, faces, { preallocate: wrong }), "invalidArgument", "preallocate");
      for (const name of ["ignoreCrossings", "anyContact"]) {
        refuses(() => limber.timeOfImpact(moving, moving, { [name]: wrong }), "invalidArgument", name);
      }
    }
    if (wrong !== "7") refuses(() => limber.readMeshBytes(new Uint8Array(1), wrong), "invalidArgument", "name");
    refuses(() => limber.distance(a, a, { budget: wrong === null ? wrong : 5 }), "invalidArgument", "budget");
    refuses(() => limber.distance(a, a, { cache: wrong }), "invalidArgument", "cache");
    refuses(() => limber.contacts(a, a, 1, { filter: wrong }), "invalidArgument", "filter");
  }
});

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
    limber.vertexFaceImpact(far, far);
    other.dispose();
  };
  const options = { motionMargin: 0, rebuildPolicy: "off", rebuildBudgetUs: 0, preallocate: true };
  const made = [
    new limber.Model(corners, faces, reading(options, disturb)),
    new limber.Model(arrayReading(corners, disturb), arrayReading(faces, disturb)),
    new limber.Model(Float64Array.from(corners), Uint32Array.from(faces), reading(options, disturb)),
  ];
  for (const model of made) {
    assert.deepEqual([...model.vertices()], corners);
    assert.deepEqual([...model.faces()], faces);
  }
  const a = made[0];
  a.moveVertices(arrayReading([0], disturb), arrayReading([0, 0, 0], disturb));
  a.moveAll(arrayReading(corners, disturb));
  a.commit();
  assert.deepEqual([...a.vertices()], corners);

  const up = [0, 0, 1], translation = arrayReading(up, disturb);
  const place = { quaternion: reading({ x: 0, y: 0, z: 0, w: 1 }, disturb), translation };
  const matrix = arrayReading([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 1], disturb);
  const turn = { rotation: arrayReading([1, 0, 0, 0, 1, 0, 0, 0, 1], disturb), translation: up };
  const budget = reading({ maxSteps: 1e9 }, disturb);
  const poses = [reading(place, disturb), matrix, reading(turn, disturb), reading({ elements: matrix }, disturb)];
  for (const poseA of poses) {
    const given = reading({ poseA, poseB: poseA, relativeError: 0, maxDistance: 50, budget }, disturb);
    assert.equal(limber.distance(a, b, given).upper, 3);
    assert.equal(limber.distance(a, b, { poseA }).upper, 2);
    const pairs = reading({ poseA, maxCount: 100, filter: () => true }, disturb);
    assert.equal(limber.contacts(a, b, 2, pairs).at(0).distance, 2);
    assert.equal(limber.closestPairs(a, b, 1, { poseA }).at(0).distance, 2);
    const point = reading({ x: 0, y: 0, z: 0 }, disturb), pose = reading({ pose: poseA, maxDistance: 50 }, disturb);
    assert.equal(limber.closestPoint(a, point, pose).closest.distance, 1);
    const surface = new limber.ClosedSurface(a);
    assert.equal(surface.contains(point, { pose: poseA }), false);
    assert.equal(surface.signedDistance(point, pose).distance, 1);
    assert.equal(surface.signedDistanceMany(arrayReading([0, 0, 0], disturb), pose).distances[0], 1);
    const moving = new limber.MovingModel(a);
    moving.setMotion(arrayReading(corners, disturb), reading({ startPose: null, endPose: poseA }, disturb));
    const times = reading({ maxTime: 1, timeError: 0, minSeparation: 2.5, separationFraction: 0, budget }, disturb);
    assert.equal(Math.round(1e9 * limber.timeOfImpact(moving, staying(b), times).upper), 5e8);
    const motionA = new limber.RigidMotion(reading({ translation: [0, 0, 0] }, disturb), poseA);
    const path = reading({ motionA, maxTime: 1, minSeparation: 2.5, distanceError: 1e-9, budget }, disturb);
    assert.equal(Math.round(1e8 * limber.timeOfImpact(a, b, path).time), 5e7);
  }
  assert.equal(limber.orthonormalized(turn.rotation)[0], 1);
  const fall = [arrayReading([0, 0, 1, ...corners.slice(0, 9)], disturb), [0, 0, -1, ...corners.slice(0, 9)]];
  assert.equal(limber.vertexFaceImpact(...fall, reading({ maxTime: 1 }, disturb)).upper, 0.5);
});

test("what is read may dispose of the arguments, which is then noticed", () => {
  const b = tetrahedron(), zero = { valueOf: () => 0 };
  const disposing = (call) => {
    const a = tetrahedron(), cache = new limber.QueryCache(), rings = new limber.NeighborRings(a, 0);
    refuses(() => call(a, () => [a, cache, rings].forEach((owner) => owner.dispose()), cache, rings), "disposed");
  };
  const still = { translation: [0, 0, 0] };
  disposing((a, free, cache) => limber.distance(a, b, reading({ cache, poseB: still }, free)));
  disposing((a, free, cache) => limber.distance(b, b, { cache, poseB: reading(still, free) }));
  disposing((a, free) => limber.distance(a, b, { budget: reading({ maxSteps: 5 }, free) }));
  disposing((a, free) => limber.collide(a, b, { poseB: reading(still, free) }));
  const matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  disposing((a, free) => limber.within(b, a, 1, { poseA: arrayReading(matrix, free) }));
  disposing((a, free) => limber.intersections(a, b, reading({ maxCount: 5, poseB: still }, free)));
  disposing((a, free) => limber.contacts(a, b, 1, { poseB: reading(still, free) }));
  disposing((a, free) => limber.closestPairs(a, b, 1, { poseB: reading(still, free) }));
  disposing((a, free) => limber.selfDistance(a, reading({ relativeError: 0 }, free)));
  disposing((a, free, cache, rings) => limber.selfContacts(a, 1, reading({ filter: rings }, free)));
  disposing((a, free) => limber.closestPointMany(a, arrayReading([0, 0, 0], free)));
  disposing((a, free) => limber.closestPointMany(a, [0, 0, 0], reading({ pose: still }, free)));
  disposing((a, free) => new limber.ClosedSurface(a).contains(reading({ x: 0, y: 0, z: 0 }, free)));
  disposing((a, free) => new limber.ClosedSurface(a).signedDistanceMany(arrayReading([0, 0, 0], free)));
  disposing((a, free) => new limber.MovingModel(a).setMotion(arrayReading(corners, free)));
  disposing((a, free) => limber.selfTimeOfImpact(staying(a), reading({ maxTime: 1 }, free)));
  disposing((a, free) => limber.selfImpacts(staying(a), reading({ maxCount: 5 }, free)));
  disposing((a, free, cache) => limber.minDistance(b, b, reading({ cache, maxTime: 1 }, free)));
  disposing((a, free) => limber.timeOfImpact(b, a, { budget: reading({ maxSteps: 5 }, free) }));
  disposing((a, free) => limber.contactOf(a, b, reading({ triangleA: 0, triangleB: 0 }, free)));
  const solid = new limber.ClosedSurface(b);
  const solidOf = (model) => new limber.ClosedSurface(model);
  disposing((a, free) => limber.signedDistance(solid, solidOf(a), reading({ relativeError: 1 }, free)));
  disposing((a, free) => limber.solidRelation(solidOf(a), solid, { poseB: reading(still, free) }));
  const sceneOf = (model) => {
    const scene = new limber.Scene();
    for (const one of [model, b]) scene.add(one);
    scene.commit();
    return scene;
  };
  disposing((a, free) => sceneOf(b).add(a, reading(still, free)));
  disposing((a, free) => sceneOf(a).setPose(1, reading(still, free)));
  disposing((a, free) => sceneOf(a).setPoses(arrayReading([0], free), matrix));
  disposing((a, free) => sceneOf(a).distance(arrayReading([0, 1], free), {}));
  disposing((a, free) => sceneOf(a).closestObjects(reading({ relativeError: 0, filter: () => true }, free)));
  disposing((a, free) => sceneOf(a).anyWithinMany([0], arrayReading(matrix, free), 1));
  disposing((a, free) => a.moveAll(arrayReading(corners, free)));
  disposing((a, free) => a.moveVertices(arrayReading([0], free), [0, 0, 0]));
  refuses(() => limber.within(b, b, zero), "invalidArgument", "maxDistance");
});

test("a filter that calls the library disturbs nothing", () => {
  const a = tetrahedron(), b = tetrahedron(), poseB = { translation: [0, 0, 2] };
  const away = { translation: [50, 50, 50] };
  const filter = () => {
    refuses(() => limber.distance(a, b, { poseA: away, poseB: away }), "busy");
    refuses(() => limber.closestPointMany(a, corners), "busy");
    refuses(() => new limber.Model(corners, faces), "busy");
    refuses(() => limber.orthonormalized([9, 0, 0, 0, 9, 0, 0, 0, 9]), "busy");
    return true;
  };
  assert.equal(limber.closestPairs(a, b, 1, { poseB, filter }).at(0).distance, 1);
});
