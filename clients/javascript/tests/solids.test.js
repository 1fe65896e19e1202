// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bodies, gradients and welding: known answers, and arguments that are not what the comments say.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { corners, faces, refuses, tetrahedron } from "./support.js";

const boxFaces = [
  0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5,
];

/** A cube from `low` to `high` in each coordinate. */
function cube(low, high) {
  const vertices = Array.from({ length: 24 }, (_, i) => ((Math.floor(i / 3) >> (i % 3)) & 1 ? high : low));
  return new limber.ClosedSurface(new limber.Model(vertices, boxFaces));
}

const at = (...translation) => ({ poseB: { translation } });
const length = ([x, y, z]) => Math.hypot(x, y, z);
const near = (x, expected, error = 1e-9) => assert.ok(Math.abs(x - expected) <= error, `${x}, not ${expected}`);

before(() => limber.init());

test("cubes have every relation", () => {
  const unit = cube(0, 1), small = cube(0.25, 0.75);
  const relation = (a, b, options) => limber.solidRelation(a, b, options).relation;
  assert.equal(relation(unit, unit, at(3, 0, 0)), "apart");
  assert.equal(relation(unit, unit, at(1, 0, 0)), "touching");
  assert.equal(relation(unit, unit, at(0.5, 0, 0)), "overlapping");
  assert.equal(relation(unit, small), "bInsideA");
  assert.equal(relation(small, unit), "aInsideB");
  assert.equal(relation(unit, unit), "equal");
  assert.equal(limber.solidRelation(unit, small).witness, null);
  assert.equal(limber.solidRelation(unit, small, at(0.25, 0, 0)).witness.pointA[0], 1);
});

test("depths of cubes are what their sides say", () => {
  const unit = cube(0, 1), { poseB } = at(0.875, 0.25, 0.5);
  const deep = limber.signedDistance(unit, unit, { poseB });
  assert.ok(!deep.areApart && deep.witness === null);
  near(deep.lower, -0.125), near(deep.upper, -0.125);
  [0.125, 0, 0].forEach((x, i) => near(deep.translation[i], x));
  const apart = limber.signedDistance(unit, unit, at(3, 0, 0));
  assert.ok(apart.areApart && apart.lower === 2 && apart.witness.pointB[0] === 3 && apart.deepest.ofA === null);
  const vertices = limber.deepestVertices(unit, unit, { poseB });
  near(vertices.maxDepth, 0.125), near(vertices.ofA.depth, 0.125), near(length(vertices.ofB.direction), 1);
  assert.deepEqual(vertices.ofB.position, [0.875, 0.25, 0.5]);
  assert.equal(vertices.ofB.vertex, 0);
  near(vertices.ofB.closest.position[0], 1);
  assert.deepEqual(limber.deepestVertices(unit, unit, at(5, 0, 0)).ofA, null);
  const along = limber.separatingTranslation(unit, unit, [2, 0, 0], at(0.25, 0, 0));
  assert.deepEqual(along.direction, [1, 0, 0]);
  near(along.lower, 0.75), near(along.upper, 0.75);
  const stopped = limber.signedDistance(unit, unit, { ...at(0.5, 0, 0), budget: { maxSteps: 1 } });
  assert.ok(stopped.lower <= -0.5 + 1e-12 && stopped.upper >= -0.5 && stopped.stoppedBy === "maxSteps");
});

test("gradients are slopes of distances", () => {
  const a = tetrahedron(), b = tetrahedron(), quaternion = [0.1, 0.3, 0.2, 1], translation = [2, 0.25, 0.5];
  const distance = (moved) => limber.distance(a, b, { poseB: { quaternion, translation: moved } }).upper;
  const options = { poseB: { quaternion, translation } }, { witness } = limber.distance(a, b, options);
  const contact = limber.contactOf(a, b, witness, options);
  assert.deepEqual([contact.triangleA, contact.triangleB], [witness.triangleA, witness.triangleB]);
  const { force, moment } = limber.poseGradientB(contact, translation), step = 1e-6;
  for (let axis = 0; axis < 3; ++axis) {
    const by = (t) => translation.map((x, i) => x + (i === axis ? t : 0));
    near((distance(by(step)) - distance(by(-step))) / (2 * step), force[axis], 1e-5);
  }
  near(limber.poseGradientA(contact, [0, 0, 0]).force[1], -force[1], 0);
  near(moment.reduce((sum, x, i) => sum + x * force[i], 0), 0);  // a moment is across its force
  const sum = limber.vertexGradientsB(contact).reduce((total, g) => total.map((x, i) => x + g[i]), [0, 0, 0]);
  sum.forEach((x, i) => near(x, force[i]));
  assert.equal(limber.vertexGradientsA(contact).length, 3);
});

test("welding makes surfaces of soups", () => {
  const soup = faces.flatMap((v) => corners.slice(3 * v, 3 * v + 3)), ids = soup.slice(0, 12).map((_, i) => i);
  refuses(() => new limber.ClosedSurface(new limber.Model(soup, ids)), "notClosed");
  const welded = limber.weld(soup, ids);
  assert.deepEqual([welded.vertices.length, welded.faces.length, welded.weldedOf.length], [12, 12, 12]);
  assert.deepEqual([...welded.weldedOf], [...welded.faces]);
  assert.ok(new limber.ClosedSurface(new limber.Model(welded.vertices, welded.faces)).contains([0.1, 0.1, 0.1]));
  assert.deepEqual([...limber.weld([0, 0, 0, 1, 0, 0, -0, 0, 0], [0, 1, 2]).weldedOf], [0, 1, 0]);
  refuses(() => limber.weld([0, 0, NaN], [0, 0, 0]), "nonFinite");
  refuses(() => limber.weld([0, 0, 0], [0, 0, 1]), "indexOutOfRange");
});

test("closest pairs end at maxDistance, and contacts have weights", () => {
  const a = tetrahedron(), options = { poseB: { translation: [2, 0, 0] } };
  const all = limber.closestPairs(a, a, 16, options);
  assert.equal(all.count, 16);
  const maxDistance = all.distances[5], some = limber.closestPairs(a, a, 16, { ...options, maxDistance });
  assert.ok(some.count >= 6 && some.count < 16 && some.distances.every((d) => d <= maxDistance));
  for (const { weightsA, pointA, triangleA } of all) {
    near(weightsA[0] + weightsA[1] + weightsA[2], 1);
    const ids = faces.slice(3 * triangleA, 3 * triangleA + 3);
    pointA.forEach((x, i) => near(ids.reduce((sum, v, k) => sum + weightsA[k] * corners[3 * v + i], 0), x));
  }
  assert.equal(limber.selfClosestPairs(a, 10, { maxDistance: 1 }).count, 0);
  refuses(() => limber.closestPairs(a, a, 1, { maxDistance: -1 }), "invalidArgument", "max_distance");
});

test("wrong arguments are refused", () => {
  const unit = cube(0, 1), a = tetrahedron();
  const contact = limber.contacts(a, a, 0, { maxCount: 1 }).at(0), witness = limber.collide(a, a).witness;
  for (const query of [limber.solidRelation, limber.deepestVertices, limber.signedDistance]) {
    refuses(() => query(unit, a), "invalidArgument", "b is no ClosedSurface");
    refuses(() => query(unit, unit, { pose: null }), "invalidArgument", '"pose"');
    refuses(() => query(unit, unit, { poseA: [1, 2] }), "invalidArgument", "poseA");
    refuses(() => query(unit, unit, { poseB: { rotation: [2, 0, 0, 0, 1, 0, 0, 0, 1] } }), "notRigid", "poseB");
  }
  for (const direction of [[0, 0, 0], [NaN, 0, 0], [1, 2], "x", [1, 2, "3"]]) {
    refuses(() => limber.separatingTranslation(unit, unit, direction), "invalidArgument", "direction");
  }
  refuses(() => limber.signedDistance(unit, unit, { relativeError: -1 }), "invalidArgument", "relative");
  refuses(() => limber.signedDistance(unit, unit, { relativeError: "1" }), "invalidArgument", "relativeError");
  refuses(() => limber.contactOf(a, a, null), "invalidArgument", "witness");
  refuses(() => limber.contactOf(a, a, { ...witness, triangleB: 4 }), "invalidArgument", "triangle");
  refuses(() => limber.contactOf(a, a, { ...witness, triangleA: 0.5 }), "invalidArgument", "witness");
  refuses(() => limber.poseGradientA(contact, [0, 0]), "invalidArgument", "center");
  refuses(() => limber.poseGradientB(undefined, [0, 0, 0]), "invalidArgument", "contact");
  refuses(() => limber.vertexGradientsA({ ...contact, weightsA: [1] }), "invalidArgument", "contact.weightsA");
  unit.model.moveVertices([0], [-1, 0, 0]);
  refuses(() => limber.solidRelation(unit, unit), "invalidArgument", "commit");
  unit.model.dispose();
  refuses(() => limber.signedDistance(unit, unit), "disposed", "the model of a");
});
