// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Sheet and body in 3D, and what the engine says of them. */

import { Box3, Matrix4, Vector3 } from 'three';
import type { Contacts } from '../../limber3d/index.js';
import { byId, onThemeChange, tokenRgb } from '../shared/dom.ts';
import { Marks } from '../shared/marks.ts';
import { Surface, SurfaceLook } from '../shared/surface.ts';
import { Viewer, framed, framedBox, upY } from '../shared/viewer.ts';
import type { Frame } from '../shared/viewer.ts';
import type { BodyPose } from './body.ts';
import { Circles, Dots, Grid } from './drawings.ts';
import type { Answers } from './engine.ts';
import type { TriangleMesh } from './hare.ts';

const frame: Frame = { center: new Vector3(0, 0.3, 0), size: 3.6 };
const home = [
  framedBox(frame, new Box3(new Vector3(-1, -0.3, -1), new Vector3(1, 0.2, 1))),
  framedBox(frame, new Box3(new Vector3(-0.4, 0, -0.4), new Vector3(0.4, 1.15, 0.4))),
];

/** Where the buttons look from. */
export const sides = {
  slanted: new Vector3(0.5, 0.42, 0.85),
  front: new Vector3(0, 0.02, 1),
  top: new Vector3(0, 1, 1e-4),
};

const one = new Vector3(1, 1, 1);

export class View {
  readonly viewer = new Viewer(byId('view'), upY);
  private readonly look = new SurfaceLook();
  private readonly marks = new Marks(this.viewer);
  private readonly sheet: Surface;
  private readonly grid: Grid;
  private readonly contactDots = new Dots();
  private readonly selfDots = new Dots();
  private readonly circles = new Circles();
  private readonly nameOfBody = { name: 'B', at: new Vector3(), isShown: () => true } as const;
  private body: Surface;

  constructor(sheet: TriangleMesh, body: TriangleMesh) {
    this.sheet = new Surface({ points: framedPoints(sheet.vertices), corners: sheet.faces }, this.look);
    this.grid = new Grid(this.sheet.positions);
    const drawings = [this.grid, this.circles, this.contactDots, this.selfDots];
    this.viewer.add(this.sheet.object, ...drawings.map(({ object }) => object));
    const nameOfSheet = { name: 'A', at: framed(frame, new Vector3(-1, 0, -1)), isShown: () => true } as const;
    this.marks.show({ names: [nameOfSheet, this.nameOfBody] });
    this.body = this.added(body);
    this.recolor();
    onThemeChange(() => this.recolor());
    this.lookFrom('slanted');
  }

  setBody(mesh: TriangleMesh): void {
    this.viewer.remove(this.body.object);
    this.body.dispose();
    this.body = this.added(mesh);
    this.recolor();
  }

  moveSheet(positions: Float64Array): void {
    framedPoints(positions, this.sheet.mesh.points);
    this.sheet.pointsHaveMoved();
  }

  moveBody(pose: BodyPose): void {
    this.body.place(placeOf(pose));
    this.nameOfBody.at.copy(this.body.farthestAlong(upY));
  }

  show({ distance, contacts, selfContacts }: Answers, label: string): void {
    const { witness } = distance;
    const [a, b] = [witness?.pointA, witness?.pointB].map((p) => framed(frame, new Vector3(...(p ?? []))));
    this.marks.show({ segment: distance.upper > 0 && witness !== null ? { a, b, label } : undefined });
    this.contactDots.show(middles(contacts));
    this.selfDots.show(middles(selfContacts));
  }

  /** Center and radius of spheres: in the world, or where the pose puts them. */
  showSpheres(spheres: Float64Array, pose: BodyPose | undefined): void {
    const shown = Float32Array.from(spheres, (c) => c / frame.size);
    this.circles.show(shown, tokenRgb(pose === undefined ? 'model-a-deep' : 'model-b-deep'));
    const ofWorld = new Matrix4().setPosition(framed(frame, new Vector3()));
    this.circles.object.matrix.copy(pose === undefined ? ofWorld : placeOf(pose));
  }

  lookFrom(side: keyof typeof sides): void {
    this.viewer.lookAtBoxes(home, sides[side]);
  }

  /** What is seen at a point of the page: the body, or the vertex of the sheet that is nearest there. */
  hit(event: MouseEvent): 'body' | number | undefined {
    const found = this.viewer.hit(event, [this.sheet.object, this.body.object]);
    if (found === undefined) return undefined;
    if (found.object === this.body.object) return 'body';
    const { a, b, c } = found.face!;
    const off = (vertex: number): number =>
      new Vector3().fromBufferAttribute(this.sheet.positions, vertex).distanceTo(found.point);
    return [a, b, c].reduce((best, vertex) => (off(vertex) < off(best) ? vertex : best));
  }

  /** A shift of the picture by pixels, in the world. */
  across(dx: number, dy: number): Vector3 {
    const { right, up } = this.viewer.axes;
    return right
      .multiplyScalar(dx)
      .addScaledVector(up, -dy)
      .multiplyScalar(this.viewer.pixel * frame.size);
  }

  private recolor(): void {
    this.sheet.setColor(tokenRgb('model-a'));
    this.body.setColor(tokenRgb('model-b'));
    this.grid.setColor(tokenRgb('model-a-deep'));
    this.contactDots.setColors(tokenRgb('hit'), [0.1, 0.1, 0.1]);
    this.selfDots.setColors(tokenRgb('mark'), [1, 1, 1]);
    this.viewer.request();
  }
  private added(mesh: TriangleMesh): Surface {
    const points = Float32Array.from(mesh.vertices, (c) => c / frame.size);
    const surface = new Surface({ points, corners: mesh.faces }, this.look);
    this.viewer.add(surface.object);
    return surface;
  }
}

/** Places the body in the frame. */
const placeOf = ({ translation, quaternion }: BodyPose): Matrix4 =>
  new Matrix4().compose(framed(frame, translation), quaternion, one);

function framedPoints(positions: Float64Array, to: Float32Array = new Float32Array(positions.length)): Float32Array {
  const center = frame.center.toArray();
  for (let i = 0; i < positions.length; ++i) to[i] = (positions[i] - center[i % 3]) / frame.size;
  return to;
}

/** The point in the middle of each contact. */
function middles(contacts: Contacts | undefined): Float32Array {
  if (contacts === undefined) return new Float32Array();
  const { pointsA, pointsB } = contacts;
  return framedPoints(pointsA.map((c, i) => (c + pointsB[i]) / 2));
}
