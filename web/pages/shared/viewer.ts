// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * A view in 3D that is turned, moved and zoomed by mouse, touch and keyboard. The projection is orthographic: lengths
 * across the view are true to scale. A picture is drawn only where something has changed.
 */

import { OrthographicCamera, Scene, Vector3, WebGLRenderer } from 'three';
import type { Object3D } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { element } from './dom.ts';
import { add, direction, length, middle, scale, subtract } from './vectors.ts';
import type { Vec3 } from './vectors.ts';

/** The world as views draw it: moved by -center and divided by size, so that float32 resolves it well. */
export interface Frame {
  center: Vec3;
  size: number;
}

/** The frame of a box of the world: its longest diagonal becomes 1. */
export function frameOf(low: Vec3, high: Vec3): Frame {
  const size = length(subtract(high, low));
  return { center: middle(low, high), size: size > 0 ? size : 1 };
}

export const framed = (frame: Frame, p: Vec3): Vec3 => scale(subtract(p, frame.center), 1 / frame.size);

/** What is up where nobody has said so: most files of these kinds have y up; in engineering, and in scenes, z is up. */
export function usualUp(names: readonly string[]): Up {
  return names.every((name) => /\.(obj|gltf|glb)$/i.test(name)) ? 'y' : 'z';
}

export type Up = 'y' | 'z';
const directionOf = { y: [0, 1, 0], z: [0, 0, 1] } as const;

/** Where the buttons of a page look from. */
export const sides = ['whole', 'top', 'front', 'side'] as const;
export type Side = (typeof sides)[number];

const halfHeight = 0.5;
const margin = 1.12; // around what is looked at
const turnStep = Math.PI / 24;
const moveStep = 0.06; // of the view's height
const zoomStep = 1.2;

export class Viewer {
  private readonly host: HTMLElement;
  private readonly renderer: WebGLRenderer | undefined;
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera();
  private controls: OrbitControls;
  private upAxis: Up;
  private readonly callbacks: (() => void)[] = [];
  private isRequested = false;
  private width = 1;
  private height = 1;

  /** `host` holds the view and gets the keys; what it has inside stays above the picture. */
  constructor(host: HTMLElement, up: Up) {
    this.host = host;
    this.upAxis = up;
    const canvas = element('canvas');
    host.prepend(canvas);
    this.renderer = Viewer.rendererFor(canvas);
    if (this.renderer === undefined) host.append(element('p', 'no-view', 'This browser has no WebGL, so no 3D view.'));
    this.controls = this.madeControls();
    host.addEventListener('keydown', (event) => this.press(event));
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  get up(): Vec3 {
    return directionOf[this.upAxis];
  }

  /** The view is as it was until it is told where to look. */
  setUp(up: Up): void {
    this.upAxis = up;
    this.controls.dispose();
    this.controls = this.madeControls();
  }

  /** Adds objects, whose coordinates are those of the frame. */
  add(...objects: Object3D[]): void {
    this.scene.add(...objects);
    this.request();
  }

  remove(...objects: Object3D[]): void {
    this.scene.remove(...objects);
    this.request();
  }

  /** Calls back after each picture, to place what lies above it. */
  onDrawn(callback: () => void): void {
    this.callbacks.push(callback);
  }

  /** Asks for a new picture, drawn with the next frame of the screen. */
  request(): void {
    if (this.isRequested) return;
    this.isRequested = true;
    requestAnimationFrame(() => {
      this.isRequested = false;
      this.draw();
    });
  }

  /** Looks at a sphere, from a direction if one is given, else from where the view is now. */
  lookAt(center: Vec3, radius: number, from?: Vec3): void {
    const now = this.camera.position.clone().sub(this.controls.target);
    const away =
      from === undefined ? direction([now.x, now.y, now.z], this.from('front')) : direction(from, this.from('front'));
    this.controls.target.set(...center);
    this.camera.position.set(...add(center, scale(away, 2)));
    this.camera.zoom = (halfHeight * Math.min(1, this.width / this.height)) / Math.max(radius, 1e-7);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.controls.saveState();
    this.request();
  }

  /** Looks at a point, as large and from the same direction as now. */
  moveTo(center: Vec3): void {
    const shift = new Vector3(...center).sub(this.controls.target);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.controls.update();
    this.request();
  }

  /** Looks at boxes from a direction, so that they fill the view. */
  lookAtBoxes(boxes: readonly (readonly [Vec3, Vec3])[], from: Vec3): void {
    this.lookAt([0, 0, 0], halfHeight, from);
    this.camera.updateMatrixWorld();
    const low = [Infinity, Infinity];
    const high = [-Infinity, -Infinity];
    for (const box of boxes) {
      for (let corner = 0; corner < 8; ++corner) {
        const p = new Vector3(box[corner & 1][0], box[(corner >> 1) & 1][1], box[corner >> 2][2]);
        p.applyMatrix4(this.camera.matrixWorldInverse);
        [p.x, p.y].forEach((c, i) => {
          low[i] = Math.min(low[i], c);
          high[i] = Math.max(high[i], c);
        });
      }
    }
    const shift = new Vector3((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, 0).applyQuaternion(
      this.camera.quaternion,
    );
    const aspect = this.width / this.height;
    const radius = Math.max(
      (high[0] - low[0]) / 2 / Math.max(1, aspect),
      (high[1] - low[1]) / 2 / Math.max(1, 1 / aspect),
    );
    this.lookAt([shift.x, shift.y, shift.z], radius * margin, from);
  }

  /** A direction to look from, by its name; "whole" shows three sides. */
  from(side: Side): Vec3 {
    const directions: Record<Up, Record<Side, Vec3>> = {
      y: { whole: [0.55, 0.62, 0.75], top: [0, 1, 1e-4], front: [0, 0, 1], side: [1, 0, 0] },
      z: { whole: [0.55, -0.75, 0.62], top: [0, -1e-4, 1], front: [0, -1, 0], side: [1, 0, 0] },
    };
    return directions[this.upAxis][side];
  }

  /** Where a point of the frame is on the view, in pixels from its upper left corner. */
  project(p: Vec3): [number, number] {
    const clip = new Vector3(...p).project(this.camera);
    return [((clip.x + 1) / 2) * this.width, ((1 - clip.y) / 2) * this.height];
  }

  /** The line that is seen as a pixel, counted from the upper left corner: a point of the frame that lies before all
   * others on it, and its direction, of length 1. */
  ray(x: number, y: number): { from: Vec3; along: Vec3 } {
    const from = new Vector3((2 * x) / this.width - 1, 1 - (2 * y) / this.height, -1).unproject(this.camera);
    const along = this.camera.getWorldDirection(new Vector3());
    return { from: [from.x, from.y, from.z], along: [along.x, along.y, along.z] };
  }

  get size(): [number, number] {
    return [this.width, this.height];
  }

  private madeControls(): OrbitControls {
    this.camera.up.set(...this.up);
    const controls = new OrbitControls(this.camera, this.host);
    controls.zoomToCursor = true;
    controls.minZoom = 0.2;
    controls.maxZoom = 1e6;
    controls.addEventListener('change', () => this.request());
    return controls;
  }

  private static rendererFor(canvas: HTMLCanvasElement): WebGLRenderer | undefined {
    const context = canvas.getContext('webgl2', { alpha: true, antialias: true, preserveDrawingBuffer: true });
    if (context === null) return undefined;
    const renderer = new WebGLRenderer({ canvas, context, alpha: true });
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    return renderer;
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    const before = Math.min(1, this.width / this.height);
    [this.width, this.height] = [clientWidth, clientHeight];
    const aspect = this.width / this.height;
    Object.assign(this.camera, { left: -halfHeight * aspect, right: halfHeight * aspect });
    Object.assign(this.camera, { top: halfHeight, bottom: -halfHeight });
    this.camera.zoom *= Math.min(1, aspect) / before;
    this.camera.updateProjectionMatrix();
    this.renderer?.setSize(this.width, this.height, false);
    this.request();
  }

  /** Draws now. */
  draw(): void {
    // The frame's objects lie within 1 of its center: the planes that bound the view are as tight as that allows.
    this.camera.updateMatrixWorld();
    const ahead = this.camera.getWorldDirection(new Vector3()).dot(this.camera.position);
    this.camera.near = -ahead - 1;
    this.camera.far = -ahead + 1;
    this.camera.updateProjectionMatrix();
    this.renderer?.render(this.scene, this.camera);
    for (const callback of this.callbacks) callback();
  }

  private press(event: KeyboardEvent): void {
    if (event.target !== this.host || event.ctrlKey || event.metaKey || event.altKey) return;
    const arrows: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const arrow = arrows[event.key];
    if (arrow !== undefined && event.shiftKey) this.move(...arrow);
    else if (arrow !== undefined) this.turn(...arrow);
    else if (event.key === '+' || event.key === '=') this.zoom(zoomStep);
    else if (event.key === '-') this.zoom(1 / zoomStep);
    else if (event.key === '0') this.controls.reset();
    else return;
    event.preventDefault();
  }

  private turn(right: number, up: number): void {
    const away = this.camera.position.clone().sub(this.controls.target);
    const axis = new Vector3(...this.up);
    away.applyAxisAngle(axis, -right * turnStep);
    const sideways = new Vector3().crossVectors(axis, away).normalize();
    const raised = away.clone().applyAxisAngle(sideways, -up * turnStep);
    if (Math.abs(raised.clone().normalize().dot(axis)) < 0.999) away.copy(raised);
    this.camera.position.copy(this.controls.target).add(away);
    this.controls.update();
    this.request();
  }

  private move(right: number, up: number): void {
    const step = (2 * halfHeight * moveStep) / this.camera.zoom;
    const shift = new Vector3(right * step, up * step, 0).applyQuaternion(this.camera.quaternion);
    const { x, y, z } = shift.add(this.controls.target);
    this.moveTo([x, y, z]);
  }

  private zoom(factor: number): void {
    this.camera.zoom *= factor;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.request();
  }
}
