// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What the program writes into pages, as the page decodes it: meshes, and where they stand.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Vector3 } from 'three';
import { Session, boxObj, module, sheetObj } from './support.mjs';

const { increasingIdsOf } = await module('shared/decode.ts');
const { Model, modelsOf, partsOf } = await module('viewer/models.ts');

const session = new Session();
const { answers, data } = session;
const pose = '0.5,-0.25,0.75,0.3,-0.4,0.5,0.6';
const wave = (f) => (x, y) => (x < 0 ? 0.3 * Math.sin(2 * x + Math.min(f, 2)) : 0.3 * Math.sin(x * y + f / 5));
const frameCount = 70; // more than two runs of frames that build on each other

before(() => {
  const sheets = Array.from({ length: frameCount }, (_, f) => session.store(`sheet${f}.obj`, sheetObj(12, wave(f))));
  const box = session.store('box.obj', boxObj([0, 0, 0], [4, 4, 4]));
  const poses = sheets.map((_, f) => `${f / 50},0.5,${1.6 + f / 70},1,0,${f / 100},0\n`).join('');
  const moving = ['--b', 'scene:ball', '--poses-b', session.store('poses.csv', poses)];
  session.make('far', 'distance', sheets[0], 'scene:ball', '--pose-a', pose, '--pose-b', '40,0,0,1,0,0,0');
  session.make('crossing', 'distance', sheets[0], sheets[9], '--pose-b', pose);
  const rows = [
    `${box},scene:ball,3,1,1`,
    `${box},scene:ball,1,1,1`,
    `${box},${box},5,0,0`,
    `${box},scene:square,1,1,1`,
  ];
  const heads = 'model_a,model_b,pose_b_tx,pose_b_ty,pose_b_tz';
  const list = session.store('pairs.csv', [heads, ...rows].map((row) => `${row}\n`).join(''));
  session.make('pairs', 'distance', '--pairs', list);
  const parts = `name,model,pose_tx\none,${box},0\ntwo,${box},3.5\nthree,scene:ball,9\n`;
  session.make('parts', 'distance', '--parts', session.store('parts.csv', parts));
  session.make('frames', 'track', '--a', ...sheets, ...moving);
  const large = sheets.slice(0, 12).map((_, f) => session.store(`large${f}.obj`, sheetObj(90, wave(f))));
  session.make('thinned', 'track', '--a', ...large, '--b', 'scene:ball', '--max-report-mb', '1');
  session.make('demo', 'demo', '--frames', '40', '--dents-per-frame', '60', '--no-check');
});

after(() => session.close());

/** The corners of a triangle of a mesh, as its matrix places it. */
const cornersIn = ({ points, corners }, matrix, t) =>
  [...corners.slice(3 * t, 3 * t + 3)].map((v) => new Vector3().fromArray(points, 3 * v).applyMatrix4(matrix));

/** How far a point is from a triangle. */
function distanceTo(point, [a, b, c]) {
  const [ab, ac, ap] = [b.clone().sub(a), c.clone().sub(a), point.clone().sub(a)];
  const normal = ab.clone().cross(ac);
  const area = normal.length();
  const off = Math.abs(normal.dot(ap)) / area;
  const parts = [ab.cross(ap).dot(normal), ap.clone().cross(ac).dot(normal)].map((part) => part / area ** 2);
  return Math.max(off, ...[...parts, 1 - parts[0] - parts[1]].map((part) => -part * Math.sqrt(area)));
}

for (const name of ['far', 'crossing', 'pairs', 'parts', 'frames', 'thinned', 'demo']) {
  test(`the closest points of ${name} lie on the triangles that the page decodes, in each row`, () => {
    const all = data[name];
    const { rows, kind, frame_count = 1, stride = 1 } = all;
    const models = modelsOf(all);
    const parts = partsOf({ frame_count, stride, ...all }, models);
    // What does not deform is rounded to 24 bits of its range.
    for (const { deforms, points } of models) assert.ok(deforms || points.includes(2 ** 24 - 1));
    let count = 0;
    rows.witness.forEach((witness, row) => {
      const isKept = (row % frame_count) % stride === 0;
      assert.equal(witness !== null, isKept, `row ${row}`);
      if (!isKept) return;
      const frame = (row % frame_count) / stride;
      const sides = kind === 'frames' ? [0, 1] : [rows.a[row], rows.b[row]];
      sides.forEach((number, side) => {
        const { model } = parts[number];
        model.moveTo(frame);
        const matrix = parts[number].placeAt(frame);
        const point = new Vector3().fromArray(witness, 3 * side);
        const off = distanceTo(point, cornersIn(model, matrix, witness[6 + side]));
        assert.ok(off <= 2 * model.step + 1e-6, `${off} in row ${row}, side ${side}`);
        ++count;
      });
    });
    assert.ok(count >= 2);
    if (name === 'thinned') assert.ok(stride > 1 && rows.status.length === 12);
  });
}

test('all frames are off by at most half a step, in any order', () => {
  const { frames } = data.frames.models[0];
  const [forward, jumping] = [new Model(data.frames.models[0]), new Model(data.frames.models[0])];
  assert.ok(frames.step < 1e-4 * 6);
  const all = frames.data.map((_, f) => (forward.moveTo(f), Float64Array.from(forward.points)));
  all.forEach((points, f) => {
    for (let v = 0; v < points.length; v += 3) {
      const [x, y, z] = [0, 1, 2].map((axis) => frames.low[axis] + frames.step * points[v + axis]);
      const [column, line] = [x, y].map((c) => -2 + Math.round((c + 2) * 3) / 3);
      const off = [x - column, y - line, z - wave(f)(column, line)].map(Math.abs);
      assert.ok(Math.max(...off) <= 0.50001 * frames.step, `${off} in frame ${f}`);
    }
  });
  for (const f of [69, 3, 33, 31, 32, 0, 38]) {
    jumping.moveTo(f);
    assert.deepEqual(Float64Array.from(jumping.points), all[f]);
  }
});

test('triangles that intersect are all marked', () => {
  const words = ['contacts', session.file('sheet0.obj'), session.file('sheet9.obj'), '--pose-b', pose, '--margin', '0'];
  const [{ pairs }] = session.ask(...words, '--max-count', '100000');
  assert.ok(pairs.length > 10);
  assert.equal(data.crossing.pair.intersections, pairs.length);
  data.crossing.rows.intersecting[0].forEach((text, side) => {
    const expected = new Set(pairs.map((pair) => pair[side === 0 ? 'triangle_a' : 'triangle_b']));
    assert.deepEqual(
      increasingIdsOf(text),
      [...expected].sort((s, t) => s - t),
    );
  });
  const { clash, intersecting } = data.pairs.rows;
  assert.deepEqual(clash, ['hard_clash', 'hard_clash', 'clear', 'surfaces_meet']);
  assert.deepEqual(
    intersecting.map((texts) => texts !== null),
    answers.pairs.map(({ status }) => status === 'collision'),
  );
});
