// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Sheet and body in 3D, and what the engine says of them. */

import { BufferAttribute, BufferGeometry, Color, GLSL3, LineSegments, ShaderMaterial } from 'three';
import type { Contacts } from '../../limber3d/index.js';
import { Marks } from '../shared/marks.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import { onThemeChange, tokenRgb } from '../shared/theme.ts';
import { direction, subtract } from '../shared/vectors.ts';
import type { Vec3 } from '../shared/vectors.ts';
import { Viewer, framed } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { Answers } from './engine.ts';
import type { TriangleMesh } from './hare.ts';
import { Circles } from './circles.ts';
import { Dots } from './dots.ts';
import { columnsOf } from './pose.ts';
import type { BodyPose } from './pose.ts';

const frame: Frame = { center: [0, 0.3, 0], size: 3.6 };
const slanted: Vec3 = [0.5, 0.42, 0.85];
const home: readonly (readonly [Vec3, Vec3])[] = [
  [framed(frame, [-1, -0.3, -1]), framed(frame, [1, 0.2, 1])],
  [framed(frame, [-0.4, 0, -0.4]), framed(frame, [0.4, 1.15, 0.4])],
];

/** Directions of the world on the picture, and how long a pixel is. */
export interface PictureAxes {
  right: Vec3;
  up: Vec3;
  away: Vec3;
  pixel: number;
}

export class View {
  readonly host: HTMLElement;
  private readonly viewer: Viewer;
  private readonly look = new SurfaceLook();
  private readonly marks: Marks;
  private readonly sheet: Surface;
  private readonly grid: LineSegments;
  private readonly gridColor = { value: new Color() };
  private readonly contactDots = new Dots();
  private readonly selfDots = new Dots();
  private readonly circles = new Circles();
  private body: Surface | undefined;

  constructor(host: HTMLElement, sheet: TriangleMesh) {
    this.host = host;
    this.viewer = new Viewer(host, 'y');
    this.sheet = new Surface({ points: framedPoints(sheet.vertices), corners: sheet.faces }, this.look);
    this.grid = this.gridOf(sheet.vertices.length / 3);
    this.viewer.add(this.sheet.object, this.grid, this.circles.object, this.contactDots.object, this.selfDots.object);
    this.marks = new Marks(host, this.viewer);
    this.marks.addName('A', 'a', framed(frame, [-1, 0, -1]), () => true);
    this.marks.addName('B', 'b', [0, 0, 0], () => true);
    onThemeChange(() => this.recolor());
    this.lookFrom('slanted');
  }

  setBody(mesh: TriangleMesh): void {
    if (this.body !== undefined) {
      this.viewer.remove(this.body.object);
      this.body.dispose();
    }
    const points = Float32Array.from(mesh.vertices, (c) => c / frame.size);
    this.body = new Surface({ points, corners: mesh.faces }, this.look);
    this.body.object.matrixAutoUpdate = false;
    this.viewer.add(this.body.object);
    this.recolor();
  }

  moveSheet(positions: Float64Array): void {
    framedPoints(positions, this.sheet.mesh.points as Float32Array);
    this.sheet.pointsHaveMoved();
  }

  moveBody(pose: BodyPose): void {
    this.body?.place(rowsOf(pose));
    if (this.body !== undefined) this.marks.moveName(1, this.body.farthestAlong([0, 1, 0]));
  }

  show({ distance, contacts, selfContacts }: Answers, label: string): void {
    const { witness } = distance;
    const isApart = witness !== null && distance.upper > 0;
    this.marks.setSegment(
      isApart ? { a: framed(frame, witness.pointA), b: framed(frame, witness.pointB), label } : undefined,
    );
    this.contactDots.show(middles(contacts));
    this.selfDots.show(middles(selfContacts));
  }

  /** Center and radius of spheres: in the world, or where the pose puts them. */
  showSpheres(spheres: Float64Array, pose: BodyPose | undefined): void {
    const shown = new Float32Array(spheres.length);
    const center = pose === undefined ? frame.center : [0, 0, 0];
    for (let i = 0; i < spheres.length; ++i) shown[i] = (spheres[i] - (i % 4 < 3 ? center[i % 4] : 0)) / frame.size;
    this.circles.show(shown);
    const rows = pose === undefined ? identity : rowsOf(pose);
    this.circles.object.matrix.set(...(rows as Parameters<typeof this.circles.object.matrix.set>));
    this.circles.setColor(tokenRgb(pose === undefined ? 'model-a-deep' : 'model-b-deep'));
  }

  lookFrom(side: 'slanted' | 'front' | 'top'): void {
    const from: Vec3 = side === 'slanted' ? slanted : side === 'front' ? [0, 0.02, 1] : [0, 1, 1e-4];
    this.viewer.lookAtBoxes(home, from);
  }

  draw(): void {
    this.viewer.draw();
  }

  /** The line of the world that is seen as a pixel of the page. */
  ray(clientX: number, clientY: number): { from: Vec3; along: Vec3 } {
    const { left, top } = this.host.getBoundingClientRect();
    const { from, along } = this.viewer.ray(clientX - left - this.host.clientLeft, clientY - top - this.host.clientTop);
    return { from: from.map((c, i) => c * frame.size + frame.center[i]) as unknown as Vec3, along };
  }

  get axes(): PictureAxes {
    const [here, right, above] = [this.ray(0, 0), this.ray(1, 0), this.ray(0, -1)];
    const across = subtract(right.from, here.from);
    return {
      right: direction(across, [1, 0, 0]),
      up: direction(subtract(above.from, here.from), [0, 1, 0]),
      away: here.along,
      pixel: Math.hypot(...across),
    };
  }

  private recolor(): void {
    this.sheet.setColor(tokenRgb('model-a'));
    this.body?.setColor(tokenRgb('model-b'));
    this.gridColor.value.setRGB(...tokenRgb('model-a-deep'));
    this.contactDots.setColors(tokenRgb('hit'), [0.1, 0.1, 0.1]);
    this.selfDots.setColors(tokenRgb('mark'), [1, 1, 1]);
    this.viewer.request();
  }

  /** Every tenth line of the sheet's grid, so that its shape is seen. */
  private gridOf(vertexCount: number): LineSegments {
    const side = Math.sqrt(vertexCount);
    const lines: number[] = [];
    for (let line = 0; line < side; line += 10) {
      for (let i = 0; i + 1 < side; ++i)
        lines.push(line * side + i, line * side + i + 1, i * side + line, (i + 1) * side + line);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', this.sheet.positions);
    geometry.setIndex(new BufferAttribute(Uint32Array.from(lines), 1));
    const material = new ShaderMaterial({
      vertexShader: `void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_Position.z -= 0.0015;
      }`,
      fragmentShader: `precision highp float;
      uniform vec3 color;
      out vec4 result;
      void main() {
        result = vec4(color, 0.55);
      }`,
      uniforms: { color: this.gridColor },
      glslVersion: GLSL3,
      transparent: true,
    });
    const made = new LineSegments(geometry, material);
    made.frustumCulled = false;
    return made;
  }
}

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

/** The rows of the matrix that places the body in the frame. */
function rowsOf(pose: BodyPose): number[] {
  const columns = columnsOf(pose);
  const at = framed(frame, pose.translation);
  return [0, 1, 2].flatMap((row) => [...columns.map((column) => column[row]), at[row]]).concat([0, 0, 0, 1]);
}

function framedPoints(positions: Float64Array, to: Float32Array = new Float32Array(positions.length)): Float32Array {
  const [x, y, z] = frame.center;
  const factor = 1 / frame.size;
  for (let i = 0; i < positions.length; i += 3) {
    to[i] = (positions[i] - x) * factor;
    to[i + 1] = (positions[i + 1] - y) * factor;
    to[i + 2] = (positions[i + 2] - z) * factor;
  }
  return to;
}

/** The point in the middle of each contact. */
function middles(contacts: Contacts | undefined): Float32Array {
  if (contacts === undefined) return new Float32Array();
  const { pointsA, pointsB } = contacts;
  return Float32Array.from(pointsA, (c, i) => ((c + pointsB[i]) / 2 - frame.center[i % 3]) / frame.size);
}
