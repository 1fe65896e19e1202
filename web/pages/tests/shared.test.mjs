// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The modules that pages share, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { module } from './support.mjs';

const { outlinesOf, planeThrough, mostPerpendicularAxis } = await module('shared/section.ts');
const { shown, grouped, ticks, roundBelow } = await module('shared/numbers.ts');
const { labelPlace } = await module('shared/labels.ts');

/** A cube over [0, 1]^3. */
const cube = {
  points: Float32Array.from([0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [i & 1, (i >> 1) & 1, i >> 2])),
  corners: Uint32Array.from([
    0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5,
  ]),
};

const horizontal = (height) => ({ normal: [0, 0, 1], offset: height, right: [1, 0, 0], up: [0, 1, 0] });

function area(line) {
  let sum = 0;
  for (let i = 0; i + 3 < line.length; i += 2) sum += line[i] * line[i + 3] - line[i + 2] * line[i + 1];
  return Math.abs(sum) / 2;
}

test('a cut through a cube is one closed square', () => {
  const outlines = outlinesOf(cube, horizontal(0.25));
  assert.equal(outlines.length, 1);
  assert.ok(outlines[0].isClosed);
  assert.ok(Math.abs(area(outlines[0].line) - 1) < 1e-12);
});

test('a cut in the plane of a face is the face or nothing', () => {
  assert.ok(Math.abs(area(outlinesOf(cube, horizontal(1))[0].line) - 1) < 1e-12);
  assert.equal(outlinesOf(cube, horizontal(0)).length, 0);
});

test('a cut through an open mesh is open, and each of its pieces is there once', () => {
  const open = { points: cube.points, corners: cube.corners.slice(0, -6) };
  const outlines = outlinesOf(open, horizontal(0.5));
  assert.equal(outlines.length, 1);
  assert.ok(!outlines[0].isClosed);
  assert.equal(outlines[0].line.length, 2 * 7);
});

test('two cubes have two outlines', () => {
  const points = Float32Array.from([...cube.points, ...cube.points.map((c, i) => (i % 3 === 0 ? c + 3 : c))]);
  const corners = Uint32Array.from([...cube.corners, ...cube.corners.map((v) => v + 8)]);
  assert.equal(outlinesOf({ points, corners }, horizontal(0.5)).length, 2);
});

test('planes hold their direction, and their drawing is upright and not mirrored', () => {
  for (const along of [
    [1, 0, 0],
    [0, 0.6, 0.8],
    [0.48, -0.6, 0.64],
  ]) {
    for (const turn of [0, 0.4, -1.2]) {
      const { normal, right, up, offset } = planeThrough([1, 2, 3], along, turn, [0, 0, 1]);
      const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      for (const [a, b] of [
        [normal, along],
        [normal, right],
        [normal, up],
        [right, up],
      ])
        assert.ok(Math.abs(dot(a, b)) < 1e-12);
      for (const a of [normal, right, up]) assert.ok(Math.abs(dot(a, a) - 1) < 1e-12);
      assert.ok(Math.abs(dot(normal, [1, 2, 3]) - offset) < 1e-12);
      assert.ok(up[2] > -1e-12);
      const cross = [
        right[1] * up[2] - right[2] * up[1],
        right[2] * up[0] - right[0] * up[2],
        right[0] * up[1] - right[1] * up[0],
      ];
      assert.ok(Math.abs(dot(cross, normal) - 1) < 1e-12);
    }
  }
});

test('drawings look from the front, the right or the top', () => {
  const drawn = (along, up) => planeThrough([0, 0, 0], along, 0, up);
  const [y, z] = [
    [0, 1, 0],
    [0, 0, 1],
  ];
  const near = (a, b) => a.forEach((c, i) => assert.ok(Math.abs(c - b[i]) < 1e-12, `${a} is not ${b}`));
  near(drawn([1, 0, 0], z).right, [1, 0, 0]); // the front: z is up, and x goes right
  near(drawn([1, 0, 0], z).normal, [0, -1, 0]);
  near(drawn([0, 1, 0], z).right, [0, 1, 0]); // the right
  near(drawn([0.6, 0.8, 0], z).up, [0, 1, 0]); // the top
  near(drawn([0.6, 0.8, 0], z).right, [1, 0, 0]);
  near(drawn([0.6, 0.8, 0], y).right, [1, 0, 0]); // the front: y is up
  near(drawn([0.6, 0, 0.8], y).right, [1, 0, 0]); // the top: the back is up
  near(drawn([0.6, 0, 0.8], y).up, [0, 0, -1]);
});

test('the normal is chosen from the axes', () => {
  assert.equal(mostPerpendicularAxis([1, 0, 0]), 1);
  assert.equal(mostPerpendicularAxis([0, 1, 0]), 0);
  assert.equal(mostPerpendicularAxis([0, 0, 1]), 1);
  assert.equal(mostPerpendicularAxis([0.6, 0.8, 0.01]), 2);
});

test('numbers are shown in few digits', () => {
  assert.deepEqual(
    [0.45314912, 1250, 12345678, 3.2e-7, 0, -0.5, 123456.7].map((x) => shown(x)),
    ['0.45315', '1250', '1.2346e7', '3.2e-7', '0', '-0.5', '123457'],
  );
  assert.equal(grouped(1234567), '1\u202f234\u202f567');
});

test('ticks are round and few', () => {
  assert.equal(roundBelow(0.7), 0.5);
  const { step, values } = ticks(0.13, 1.02, 6);
  assert.equal(step, 0.2);
  assert.deepEqual(
    values.map((v) => v.toFixed(1)),
    ['0.2', '0.4', '0.6', '0.8', '1.0'],
  );
});

test('ticks end, whatever the range', () => {
  assert.deepEqual(ticks(1, 1, 6), { step: 0, values: [] });
  assert.deepEqual(ticks(0, 0, 6), { step: 0, values: [] });
  for (const [low, high] of [
    [0, 5e-324],
    [1e20, 1.0000001e20],
    [0, 1e300],
  ]) {
    assert.ok(ticks(low, high, 6).values.length <= 7);
  }
});

test('labels stay off their segment, and inside', () => {
  const [left, base] = labelPlace([100, 100], [200, 110], 60, [400, 300]);
  assert.ok(base < 100 && left > 100);
  const [beside] = labelPlace([100, 100], [104, 200], 60, [400, 300]);
  assert.ok(beside > 104);
  const [inside] = labelPlace([390, 100], [392, 200], 60, [400, 300]);
  assert.ok(inside + 60 <= 391);
});
