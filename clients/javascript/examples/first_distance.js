// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A sheet that waves under a ball: moves, commits, distances and contacts.
import { Model, QueryCache, contacts, distance, init } from "limber3d";

/** A ball of triangles around the origin. */
function ball(radius, slices, stacks) {
  const vertices = [], faces = [];
  for (let j = 0; j <= stacks; ++j) {
    for (let i = 0; i < slices; ++i) {
      const theta = (Math.PI * j) / stacks, phi = (2 * Math.PI * i) / slices;
      const ring = radius * Math.sin(theta);
      vertices.push(ring * Math.cos(phi), ring * Math.sin(phi), radius * Math.cos(theta));
      if (j === stacks) continue;
      const a = j * slices + i, b = j * slices + ((i + 1) % slices);
      faces.push(a, a + slices, b, b, a + slices, b + slices);
    }
  }
  return new Model(new Float32Array(vertices), new Uint32Array(faces));
}

/** The vertices of a sheet of n x n squares over [-1, 1] x [-1, 1], at some time. */
function wave(n, time, vertices = new Float32Array(3 * (n + 1) ** 2)) {
  for (let j = 0, k = 0; j <= n; ++j) {
    for (let i = 0; i <= n; ++i) {
      const x = (2 * i) / n - 1, y = (2 * j) / n - 1;
      vertices[k++] = x;
      vertices[k++] = y;
      vertices[k++] = 0.2 * Math.sin(5 * x + time) * Math.cos(4 * y);
    }
  }
  return vertices;
}

function squares(n) {
  const faces = [];
  for (let j = 0; j < n; ++j) {
    for (let i = 0; i < n; ++i) {
      const a = j * (n + 1) + i;
      faces.push(a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
  }
  return new Uint32Array(faces);
}

await init();
const n = 60;
const sheet = new Model(wave(n, 0), squares(n));
const stone = ball(0.3, 24, 16);
const cache = new QueryCache();
for (let frame = 0; frame < 10; ++frame) {
  sheet.moveAll(wave(n, 0.3 * frame));
  sheet.commit();
  const poseB = { translation: [0.1, 0, 0.9 - 0.1 * frame] };
  const near = distance(sheet, stone, { poseB, cache });
  const close = contacts(sheet, stone, 0.02, { poseB });
  console.log(`frame ${frame}: ${near.upper.toFixed(4)} apart, ${near.status}; ${close.count} pairs within 0.02`);
}
for (const used of [sheet, stone, cache]) used.dispose();
