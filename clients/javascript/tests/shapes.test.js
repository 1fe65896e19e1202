// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Shapes next to formulas, wherever models are taken, and arguments that are not what the comments say.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import * as limber from "limber3d";
import { Shape } from "limber3d";
import { refuses, tetrahedron } from "./support.js";

const at = (...translation) => ({ poseB: { translation } });
const near = (x, expected, error = 1e-12) => assert.ok(Math.abs(x - expected) <= error, `${x}, not ${expected}`);
const upper = (a, b, ...translation) => limber.distance(a, b, at(...translation)).upper;

before(() => limber.init());

test("distances are what formulas say", () => {
  const point = Shape.sphere(0), ball = Shape.sphere(0.5), rod = Shape.capsule([0, 0, -1], { x: 0, y: 0, z: 1 }, 0.25);
  assert.deepEqual([ball.radius, ball.isSolid, ball.deviation], [0.5, false, 0]);
  const found = limber.distance(ball, rod, at(2, 0, 0.5));
  assert.deepEqual([found.lower, found.upper, found.witness.pointA], [1.25, 1.25, [0.5, 0, 0]]);
  assert.equal(limber.collide(ball, rod, at(0.75, 0, 0)).answer, "yes");
  assert.deepEqual([1.25, 1.24].map((d) => limber.within(ball, rod, d, at(2, 0, 0)).answer), ["yes", "no"]);
  assert.equal(upper(Shape.box([1, 2, 3]), point, 1, 5, 0), 3);
  near(upper(Shape.box([1, 2, 3], 0.25), point, 4, 6, 0), 4.75);
  near(upper(Shape.halfSpace([0, 0, 2], -1.5, 100), ball, 3, 4, 0), 1);
  const cylinder = Shape.cylinder([0, 0, 0], [0, 0, 1], 1, 0.01), gap = limber.distance(cylinder, ball, at(3, 0, 0.5));
  assert.ok(cylinder.deviation > 0 && cylinder.deviation <= 0.0101 && cylinder.isSolid);
  assert.ok(gap.lower <= 1.5 && 1.5 <= gap.upper + cylinder.deviation);
});

test("points make hulls and clouds, and heights are rows and columns", () => {
  const corners = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0.1, 0.1];
  for (const points of [corners, Float32Array.from(corners), Float64Array.from(corners)]) {
    const hull = Shape.convexHull(points), cloud = Shape.pointCloud(points, 0.25);
    assert.ok(hull.isSolid && !cloud.isSolid);
    assert.equal(limber.collide(hull, Shape.sphere(0), at(0.125, 0.125, 0.125)).answer, "yes");
    near(upper(hull, Shape.sphere(0), 1, 1, 1), 2 / Math.sqrt(3));
    const { witness, upper: gap } = limber.distance(cloud, Shape.sphere(0), at(0, 3, 0));
    assert.deepEqual([gap, witness.triangleA], [1.75, 2]);
  }
  near(upper(Shape.convexHull(corners, 0.5), Shape.sphere(0), 1, 1, 1), 2 / Math.sqrt(3) - 0.5);
  assert.ok(!Shape.convexHull([0, 0, 0, 1, 0, 0, 0, 1, 0]).isSolid);
  for (const heights of [[0, 1, 2, 3, 4, 5], Float32Array.of(0, 1, 2, 3, 4, 5), Float64Array.of(0, 1, 2, 3, 4, 5)]) {
    const field = Shape.heightField(heights, 3, 2, 0.5, 2), point = Shape.sphere(0);
    for (let i = 0; i < 6; ++i) assert.equal(upper(field, point, 0.5 * (i % 3), 2 * Math.floor(i / 3), i), 0);
  }
});

test("shapes are taken where models are", () => {
  const model = tetrahedron(), ball = Shape.sphere(0.5), options = at(2, 0, 0);
  const found = limber.contacts(model, ball, 0.5, options), meeting = at(1.25, 0, 0);
  assert.ok(found.count > 0 && found.distances.every((d) => d === 0.5));
  assert.equal(limber.intersections(model, ball, meeting).count, limber.contacts(model, ball, 0, meeting).count);
  assert.equal(limber.closestPairs(ball, model, 3, { poseA: options.poseB }).distances[0], 0.5);
  const { witness } = limber.distance(model, ball, options);
  assert.equal(limber.contactOf(model, ball, witness, options).distance, 0.5);
  const motionB = new limber.RigidMotion({ translation: [5, 0, 0] }, { translation: [0, 0, 0] });
  near(limber.timeOfImpact(model, ball, { motionB }).time, 0.7, 1e-4);
  near(limber.timeOfImpact(ball, model, { motionA: motionB }).time, 0.7, 1e-4);
  assert.equal(limber.minDistance(ball, ball, { motionB }).upper, 0);
  assert.equal(limber.collide(Shape.box([2, 2, 2]), model).answer, "yes");
});

test("bad shapes are refused", () => {
  refuses(() => Shape.sphere(-1), "invalidArgument", "sphere: radius");
  refuses(() => Shape.sphere("1"), "invalidArgument", "radius");
  refuses(() => Shape.sphere(), "invalidArgument", "radius");
  refuses(() => Shape.capsule([0, 0, 0], [0, NaN, 0], 1), "invalidArgument", "capsule");
  refuses(() => Shape.capsule([0, 0], [0, 0, 1], 1), "invalidArgument", "start");
  refuses(() => Shape.box([1, -1, 1]), "invalidArgument", "half extents");
  refuses(() => Shape.cylinder([0, 0, 0], [0, 0, 0], 1, 0.1), "invalidArgument", "cylinder");
  refuses(() => Shape.cylinder([0, 0, 0], [0, 0, 1], 1), "invalidArgument", "maxError");
  refuses(() => Shape.halfSpace([0, 0, 0], 0, 1), "invalidArgument", "normal");
  refuses(() => Shape.convexHull([]), "invalidArgument", "there must be a point");
  refuses(() => Shape.convexHull([0, 1]), "sizeMismatch", "points");
  refuses(() => Shape.pointCloud([0, 0, 0, 0, NaN, 0], 1), "invalidArgument", "point 1");
  refuses(() => Shape.heightField([1, 2, 3, 4], 2, 3, 1, 1), "sizeMismatch", "heights");
  refuses(() => Shape.heightField([1, 2, 3], 2, 1.5, 1, 1), "sizeMismatch", "heights");
  refuses(() => Shape.heightField([1, 2, 3, 4, 5, 6], -2, -3, 1, 1), "invalidArgument", "height_field");
  refuses(() => Shape.heightField([1, 2], 2, 1, 1, 1), "invalidArgument", "height_field");
  refuses(() => Shape.heightField([1, 2, 3, "4"], 2, 2, 1, 1), "invalidArgument", "heights[3]");
  refuses(() => Shape.heightField("heights", 2, 2, 1, 1), "invalidArgument", "heights");
  refuses(() => new Shape(), "invalidArgument", "Shape.sphere()");
});

test("what needs a mesh takes no shape, and what has been disposed of is refused", () => {
  const ball = Shape.sphere(1), model = tetrahedron();
  refuses(() => limber.closestPoint(ball, [0, 0, 0]), "invalidArgument", "no Model");
  refuses(() => limber.selfCollide(ball), "invalidArgument", "no Model");
  refuses(() => new limber.ClosedSurface(ball), "invalidArgument", "no Model");
  refuses(() => new limber.MovingModel(ball), "invalidArgument", "no Model");
  refuses(() => limber.distance(model, {}), "invalidArgument", "b is no Model or Shape");
  refuses(() => limber.timeOfImpact(ball, 3), "invalidArgument", "b is no Model or Shape");
  ball.dispose();
  refuses(() => limber.distance(model, ball), "disposed", "b");
  assert.equal(ball.radius, 1);
});
