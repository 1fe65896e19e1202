// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The modules and the colours of the pages, without a browser.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { Vector3 } from 'three';
import { module, pages } from './support.mjs';

const { isClosed, mostPerpendicularAxis, outlinesOf, planeThrough } = await module('viewer/cut.ts');

const { shown, grouped, inPage, percentile, ticks, roundBelow } = await module('shared/numbers.ts');
const { windowLength, windowsOf } = await module('viewer/charts.ts');
const { labelPlace } = await module('shared/marks.ts');
const { worstFirst: worstFrames } = await module('viewer/data.ts');
const { mapColors } = await module('shared/surface.ts');

const vector = (...coordinates) => new Vector3(...coordinates);

/** A cube over [0, 1]^3. */
const cube = {
  points: Float32Array.from([0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [i & 1, (i >> 1) & 1, i >> 2])),
  corners: Uint32Array.from([
    0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5,
  ]),
};
const horizontal = (offset) => ({ normal: vector(0, 0, 1), offset, up: vector(0, 1, 0) });
const area = (line) => Math.abs(line.slice(1).reduce((sum, q, i) => sum + line[i].x * q.y - q.x * line[i].y, 0)) / 2;

test('a cut through a cube is one closed square', () => {
  const outlines = outlinesOf(cube, horizontal(0.25));
  assert.equal(outlines.length, 1);
  assert.ok(isClosed(outlines[0]));
  assert.ok(Math.abs(area(outlines[0]) - 1) < 1e-12);
  for (const p of outlines[0]) assert.equal(p.z, 0.25);
});

test('a cut in the plane of a face is the face or nothing', () => {
  assert.ok(Math.abs(area(outlinesOf(cube, horizontal(1))[0]) - 1) < 1e-12);
  assert.equal(outlinesOf(cube, horizontal(0)).length, 0);
});

test('a cut through an open mesh is open, and each of its pieces is there once', () => {
  const outlines = outlinesOf({ points: cube.points, corners: cube.corners.slice(0, -6) }, horizontal(0.5));
  assert.equal(outlines.length, 1);
  assert.ok(!isClosed(outlines[0]));
  assert.equal(outlines[0].length, 7);
});

test('two cubes have two outlines', () => {
  const points = Float32Array.from([...cube.points, ...cube.points.map((c, i) => (i % 3 === 0 ? c + 3 : c))]);
  const corners = Uint32Array.from([...cube.corners, ...cube.corners.map((v) => v + 8)]);
  assert.equal(outlinesOf({ points, corners }, horizontal(0.5)).length, 2);
});

test('planes hold their direction, and their drawing is upright', () => {
  const point = vector(1, 2, 3);
  for (const along of [vector(1, 0, 0), vector(0, 0.6, 0.8), vector(0.48, -0.6, 0.64)]) {
    for (const turn of [0, 0.4, -1.2]) {
      const { normal, up, offset } = planeThrough(point, along, turn, vector(0, 0, 1));
      for (const zero of [normal.dot(along), normal.dot(up), normal.dot(point) - offset, normal.length() - 1]) {
        assert.ok(Math.abs(zero) < 1e-12);
      }
      assert.ok(Math.abs(up.length() - 1) < 1e-12 && up.z > -1e-12);
    }
  }
});

test('drawings look from the front, the right or the top, and are not mirrored', () => {
  const [y, z] = [vector(0, 1, 0), vector(0, 0, 1)];
  for (const [along, worldUp, normal, up] of [
    [[1, 0, 0], z, [0, -1, 0], [0, 0, 1]], // the front
    [[0, 1, 0], z, [1, 0, 0], [0, 0, 1]], // the right
    [[0.6, 0.8, 0], z, [0, 0, 1], [0, 1, 0]], // the top: the back is up
    [[0.6, 0.8, 0], y, [0, 0, 1], [0, 1, 0]], // the front
    [[0.6, 0, 0.8], y, [0, 1, 0], [0, 0, -1]], // the top
  ]) {
    const plane = planeThrough(vector(), vector(...along), 0, worldUp);
    assert.ok(plane.normal.distanceTo(vector(...normal)) < 1e-12, `${plane.normal.toArray()}`);
    assert.ok(plane.up.distanceTo(vector(...up)) < 1e-12, `${plane.up.toArray()}`);
  }
});

test('the normal is chosen from the axes', () => {
  const chosen = [vector(1, 0, 0), vector(0, 1, 0), vector(0, 0, 1), vector(0.6, 0.8, 0.01)].map(mostPerpendicularAxis);
  assert.deepEqual(chosen, [1, 0, 1, 2]);
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

test('round numbers are at most a number', () => {
  assert.deepEqual([1, 1.01, 4.9, 5.1, 0.03, 1700].map(roundBelow), [1, 1, 2, 5, 0.02, 1000]);
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
  const rest = values.slice(20).filter((value) => value !== null);
  rest.sort((a, b) => a - b);
  assert.equal(rest.length, 29); // what is left over is in the last window
  assert.deepEqual([low[20], median[33], high[49]], [rest[1], rest[14], rest[27]]);
  for (const list of [low, median, high, largest]) assert.equal(list.length, 50);
  const marked = largest.flatMap((value, i) => (value === null ? [] : [i]));
  assert.deepEqual(marked, [values.indexOf(20), values.indexOf(120)]);
  assert.deepEqual(windowsOf([null, null], 20).median, [null, null]);
});

test('ticks are round and few, and end whatever the range', () => {
  const { step, values } = ticks(0.13, 1.02, 6);
  assert.equal(step, 0.2);
  assert.equal(values.map((v) => v.toFixed(1)).join(' '), '0.2 0.4 0.6 0.8 1.0');
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

test('the worst frames come first', () => {
  const rows = {
    status: ['exact', 'collision', 'exact', 'beyond_limit', 'exact', 'exact'],
    lower: [2, 0, 1, 9, 1, 7],
    upper: [2, 0, 1.5, null, 1, 7],
    depth: Array(6).fill(null),
  };
  assert.deepEqual(worstFrames({ rows, impacts: [] }), [1, 4, 2, 0, 5, 3]);
  const status = [null, 'clear', 'clear', 'clear', 'clear', 'contact'];
  assert.deepEqual(worstFrames({ rows, impacts: [{ name: 'impact', status }] }), [1, 5, 4, 2, 0, 3]);
  // What a model does with itself is not between both.
  assert.deepEqual(worstFrames({ rows, impacts: [{ name: 'impact_self_a', status }] })[0], 1);
  const deep = { ...rows, depth: [0.5, 0, 1, 0, 0, 0] };
  assert.deepEqual(worstFrames({ rows: deep, impacts: [] }), [2, 0, 1, 4, 5, 3]);
});

test('labels stay off their segment, and inside', () => {
  const [left, base] = labelPlace([100, 100], [200, 110], 60, [400, 300]);
  assert.ok(base < 100 && left > 100);
  const [beside] = labelPlace([100, 100], [104, 200], 60, [400, 300]);
  assert.ok(beside > 104);
  const [inside] = labelPlace([390, 100], [392, 200], 60, [400, 300]);
  assert.ok(inside + 60 <= 391);
  const badge = [140, 145];
  const [otherSide] = labelPlace([100, 100], [104, 200], 60, [400, 300], [badge]);
  assert.ok(otherSide + 60 < 100);
  const [, below] = labelPlace([100, 150], [200, 160], 60, [400, 300], [badge]);
  assert.ok(below > 160);
});

// Contrast of all texts and marks by the formula of WCAG 2.
const css = readFileSync(join(pages, 'shared/page.css'), 'utf8');
const [light, dark] = [...css.matchAll(/:root \{([^}]*)\}/g)].map(([, block]) =>
  Object.fromEntries([...block.matchAll(/--([\w-]+): (#\w+)/g)].map(([, name, color]) => [name, color])),
);
const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
const linear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
function luminance(hex) {
  const [r, g, b] = rgb(hex).map(linear);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

// AA asks for 4.5 where there is text, and for 3 where a mark has to be told from what is around it.
const grounds = [
  [4.5, ['page', 'card'], ['ink', 'soft', 'good', 'bad']],
  [4.5, ['field'], ['ink']],
  [4.5, ['accent'], ['on-accent']],
  [4.5, ['badge-a', 'badge-b'], ['on-badge']],
  [4.5, ['bad'], ['on-bad']],
  [4.5, ['hit'], ['on-hit']],
  [3, ['page', 'card'], ['accent', 'edge', 'mark', 'model-a', 'model-b']],
];

test('texts and marks are told from their ground, light and dark', () => {
  for (const theme of [light, { ...light, ...dark }]) {
    for (const [least, ground, marks] of grounds) {
      for (const [first, second] of marks.flatMap((mark) => ground.map((on) => [mark, on]))) {
        const [low, high] = [luminance(theme[first]), luminance(theme[second])].sort((a, b) => a - b);
        const contrast = (high + 0.05) / (low + 0.05);
        assert.ok(contrast >= least, `${first} on ${second}: ${contrast}`);
      }
    }
  }
});

test('the map goes from yellow to blue, and becomes darker in steps that are about equal', () => {
  const lightness = mapColors.map(luminance).map((y) => (y > 0.008856 ? 116 * Math.cbrt(y) - 16 : 903.3 * y));
  const steps = lightness.slice(1).map((next, i) => lightness[i] - next);
  const mean = steps.reduce((a, b) => a + b) / steps.length;
  assert.ok(mean > 3, `${mean}`);
  for (const step of steps) assert.ok(step > 0.6 * mean && step < 1.5 * mean, `${step} of ${mean}`);
  const [near, far] = [mapColors[0], mapColors[mapColors.length - 1]].map(rgb);
  assert.ok(near[0] > near[2] + 0.3 && near[1] > near[2] + 0.3, `${near}`);
  assert.ok(far[2] > far[0] + 0.2 && far[2] > far[1] + 0.2, `${far}`);
});
