// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What the program writes into pages, as the page decodes it: meshes, where they stand, and their distances.
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
  const floor = session.store('floor.obj', 'v -50 -50 0\nv 50 -50 0\nv 50 50 0\nv -50 50 0\nf 1 2 3\nf 1 3 4\n');
  const box = session.store('box.obj', boxObj([0, 0, 0], [4, 4, 4]));
  const poses = sheets.map((_, f) => `${f / 50},0.5,${1.6 + f / 70},1,0,${f / 100},0\n`).join('');
  const moving = ['--b', 'scene:ball', '--poses-b', session.store('poses.csv', poses)];
  session.make('far', 'distance', sheets[0], 'scene:ball', '--pose-a', pose, '--pose-b', '40,0,0,1,0,0,0');
  session.make('floor', 'distance', floor, 'scene:ball', '--pose-b', '7,-3,1.5,1,0,0,0');
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
const cornersIn = ({ mesh }, matrix, t) =>
  [...mesh.corners.slice(3 * t, 3 * t + 3)].map((v) =>
    new Vector3().fromArray(mesh.points, 3 * v).applyMatrix4(matrix),
  );

/** How far a point is from a triangle. */
function distanceTo(point, [a, b, c]) {
  const [ab, ac, ap] = [b.clone().sub(a), c.clone().sub(a), point.clone().sub(a)];
  const normal = ab.clone().cross(ac);
  const area = normal.length();
  const off = Math.abs(normal.dot(ap)) / area;
  const parts = [ab.cross(ap).dot(normal), ap.clone().cross(ac).dot(normal)].map((part) => part / area ** 2);
  return Math.max(off, ...[...parts, 1 - parts[0] - parts[1]].map((part) => -part * Math.sqrt(area)));
}

const inWorld = { center: new Vector3(), size: 1 };

for (const name of ['far', 'floor', 'crossing', 'pairs', 'parts', 'frames', 'thinned', 'demo']) {
  test(`the closest points of ${name} lie on the triangles that the page decodes, in each row`, () => {
    const all = data[name];
    const { rows, kind, frame_count = 1, stride = 1 } = all;
    const models = modelsOf(all);
    const parts = partsOf({ frame_count, stride, ...all }, models);
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
        const matrix = parts[number].matrixAt(frame, inWorld);
        const point = new Vector3().fromArray(witness, 3 * side);
        const shown = model.shownTriangles([witness[6 + side]]).map((t) => cornersIn(model, matrix, t));
        const off = Math.min(...shown.map((corners) => distanceTo(point, corners)));
        assert.ok(off <= 2 * model.step + 1e-6, `${off} in row ${row}, side ${side}`);
        ++count;
      });
    });
    assert.ok(count >= 2);
    if (name === 'thinned') assert.ok(stride > 1 && rows.status.length === 12);
  });
}

test('positions are off by at most half a step, which is small', () => {
  const [a] = modelsOf(data.far);
  const { low, step } = data.far.models[0].positions;
  assert.equal(data.far.models[0].parts, undefined); // no edge is long next to its distance
  assert.ok(Math.max(...step) < 1e-6);
  const matrix = partsOf({ frame_count: 1, stride: 1, ...data.far }, [a, a])[0].matrixAt(0, inWorld);
  // Edges along x are as long as in the file, and each is there.
  const lengths = [...Array(a.mesh.corners.length / 3).keys()].map((t) => {
    const [p, q] = cornersIn(a, matrix, t);
    return p.distanceTo(q);
  });
  assert.equal(lengths.length, 288);
  const at = (i, j) => [-2 + i / 3, -2 + j / 3, wave(0)(-2 + i / 3, -2 + j / 3)];
  const expected = [...Array(144).keys()].map((k) => {
    const [i, j] = [k % 12, Math.floor(k / 12)];
    return new Vector3(...at(i, j)).distanceTo(new Vector3(...at(i + 1, j)));
  });
  for (const [k, length] of expected.entries()) assert.ok(Math.abs(length - lengths[2 * k]) < 1e-5, `${k}`);
  assert.ok(low.every(Number.isFinite));
});

test('all frames are off by at most half a step, in any order', () => {
  const { frames } = data.frames.models[0];
  const [forward, jumping] = [new Model(data.frames.models[0]), new Model(data.frames.models[0])];
  assert.ok(frames.step < 1e-4 * 6);
  const all = frames.data.map((_, f) => (forward.moveTo(f), Float64Array.from(forward.mesh.points)));
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
    assert.deepEqual(Float64Array.from(jumping.mesh.points), all[f]);
  }
});

test('long edges are divided so that the map sees what is near, and the parts of a triangle cover it once', () => {
  const [floor] = modelsOf(data.floor);
  const parts = partsOf({ frame_count: 1, stride: 1, ...data.floor }, modelsOf(data.floor));
  const matrix = parts[0].matrixAt(0, inWorld);
  const ids = [0, 1].map((id) => floor.shownTriangles([id]));
  assert.equal(ids.flat().length, floor.mesh.corners.length / 3);
  assert.ok(ids.flat().length > 500);
  const uses = new Map();
  for (const part of ids) {
    const areas = part.map((t) => {
      const [a, b, c] = cornersIn(floor, matrix, t);
      const corners = [...floor.mesh.corners.slice(3 * t, 3 * t + 3)];
      for (const [i, v] of corners.entries()) {
        const key = [v, corners[(i + 1) % 3]].sort().join(' ');
        uses.set(key, [...(uses.get(key) ?? []), [a, b, c][i].distanceTo([a, b, c][(i + 1) % 3])]);
      }
      return b.sub(a).cross(c.sub(a)).length() / 2;
    });
    assert.ok(Math.abs(areas.reduce((x, y) => x + y) - 5000) < 0.01);
  }
  const border = [...uses.values()].filter((lengths) => lengths.length === 1).flat();
  assert.ok([...uses.values()].every((lengths) => lengths.length <= 2));
  assert.ok(Math.abs(border.reduce((x, y) => x + y) - 400) < 0.01);
  const ball = new Vector3(7, -3, 1.5);
  const points = [...floor.distances.keys()].map((v) =>
    new Vector3().fromArray(floor.mesh.points, 3 * v).applyMatrix4(matrix),
  );
  points.forEach((p, v) => assert.ok(Math.abs(floor.distances[v] - (p.distanceTo(ball) - 1)) < 0.02, `${v}`));
  assert.ok(Math.abs(Math.min(...floor.distances) - 0.5) < 0.05);
});

test('triangles that intersect are all marked', () => {
  const words = ['contacts', session.file('sheet0.obj'), session.file('sheet9.obj'), '--pose-b', pose, '--margin', '0'];
  const [{ pairs }] = session.ask(...words, '--max-count', '100000');
  assert.ok(pairs.length > 10);
  assert.equal(data.crossing.pair.intersections, pairs.length);
  assert.ok(data.crossing.pair.contact_normal.every(Number.isFinite));
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
