// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The modules that pages share, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { module } from './support.mjs';

const { outlinesOf, planeThrough, mostPerpendicularAxis } = await module('shared/section.ts');
const { shown, grouped, inPage, ticks, roundAbove, roundBelow } = await module('shared/numbers.ts');
const { percentile, windowLength, windowsOf } = await module('shared/windows.ts');
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

test('texts of the terminal are shown with the units of pages', () => {
  const words = inPage('1 234 567 moves in 3 of 20 000, 10 %, median 17 us, p99 141 us, max 8 115 us, users');
  const [n, u] = ['\u202f', '\u00a0'];
  const times = `median 17${u}\u00b5s, p99 141${u}\u00b5s, max 8${n}115${u}\u00b5s, users`;
  assert.equal(words, `1${n}234${n}567 moves in 3 of 20${n}000, 10${u}%, ${times}`);
});

test('round numbers enclose a number', () => {
  for (const [number, below, above] of [
    [1, 1, 1],
    [1.01, 1, 2],
    [4.9, 2, 5],
    [5.1, 5, 10],
    [0.03, 0.02, 0.05],
    [1700, 1000, 2000],
  ]) {
    assert.equal(roundBelow(number), below);
    assert.ok(Math.abs(roundAbove(number) - above) < 1e-12, `${roundAbove(number)}`);
  }
});

test('few frames are shown one by one, many in windows of at least 20', () => {
  assert.deepEqual([1, 200, 201, 600, 801, 2000, 100000].map(windowLength), [1, 1, 20, 20, 50, 50, 5000]);
  assert.equal(percentile([], 0.5), undefined);
  assert.deepEqual(
    [0, 0.05, 0.051, 0.5, 0.95, 1].map((part) => percentile([...Array(20).keys()], part)),
    [0, 0, 1, 9, 18, 19],
  );
});

test('windows have percentiles and the place of their largest value', () => {
  const values = Array.from({ length: 50 }, (_, i) => (i === 33 ? null : ((i * 7) % 20) + (i < 20 ? 1 : 101)));
  const { low, median, high, largest } = windowsOf(values, 20);
  assert.deepEqual([low[0], median[0], high[0]], [1, 10, 19]); // of 1 to 20
  const rest = values
    .slice(20)
    .filter((value) => value !== null)
    .sort((a, b) => a - b);
  assert.equal(rest.length, 29); // what is left over is in the last window
  assert.deepEqual([low[20], median[33], high[49]], [rest[1], rest[14], rest[27]]);
  for (const list of [low, median, high, largest]) assert.equal(list.length, 50);
  const marked = largest.flatMap((value, i) => (value === null ? [] : [i]));
  assert.deepEqual(marked, [values.indexOf(20), values.indexOf(120)]);
  assert.deepEqual(windowsOf([null, null], 20).median, [null, null]);
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
