// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What tests share.
import assert from "node:assert/strict";
import * as limber from "limber3d";

/** Throws a LimberError of this code; each of `parts` is in its message. */
export function refuses(body, code, ...parts) {
  assert.throws(body, (error) => {
    assert.ok(error instanceof limber.LimberError && error instanceof Error, String(error.stack));
    assert.equal(error.code, code, error.message);
    for (const part of parts) assert.ok(error.message.includes(part), `${error.message} lacks ${part}`);
    return true;
  });
}

export const corners = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1];
export const faces = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
export const tetrahedron = () => new limber.Model(corners, faces);

/** Vertices of n x n squares over [0, 1] x [0, 1] at heights z(v), and their triangles. */
export function grid(n, z = () => 0) {
  const vertices = Float32Array.from({ length: 3 * (n + 1) ** 2 }, (_, i) => {
    const v = Math.floor(i / 3);
    return [(v % (n + 1)) / n, Math.floor(v / (n + 1)) / n, z(v)][i % 3];
  });
  const triangles = [];
  for (let j = 0; j < n; ++j) {
    for (let i = 0; i < n; ++i) {
      const a = j * (n + 1) + i;
      triangles.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
  }
  return [vertices, Uint32Array.from(triangles)];
}

/** A scene of tetrahedra of size 1 at x = 0, 0.75, 1.5, ... */
export function row(count, model = tetrahedron()) {
  const scene = new limber.Scene();
  for (let i = 0; i < count; ++i) assert.equal(scene.add(model, { translation: [0.75 * i, 0, 0] }), i);
  scene.commit();
  return scene;
}
