// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * A view in 3D that is turned, moved and zoomed by mouse, touch and keyboard. The projection is orthographic: lengths
 * across the view are true to scale. A picture is drawn only where something has changed.
 */

import { Box3, MOUSE, Matrix4, OrthographicCamera, Scene, TOUCH, Vector3, WebGLRenderer } from 'three';
import type { Object3D } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { element } from './dom.ts';

/** The world as views draw it: moved by -center and divided by size, so that float32 resolves it well. */
export interface Frame {
  center: Vector3;
  size: number;
}

/** The frame of a box of the world: its longest diagonal becomes 1. */
export function frameOf(box: Box3): Frame {
  const size = Math.hypot(...box.getSize(new Vector3()));
  return { center: box.getCenter(new Vector3()), size: size > 0 ? size : 1 };
}

export const framed = ({ center, size }: Frame, p: Vector3): Vector3 => p.clone().sub(center).divideScalar(size);

export const framedBox = (frame: Frame, { min, max }: Box3): Box3 => new Box3(framed(frame, min), framed(frame, max));

/** From the world to the frame. */
export function matrixInFrame({ center, size }: Frame): Matrix4 {
  const factor = 1 / size;
  return new Matrix4().makeScale(factor, factor, factor).setPosition(center.clone().multiplyScalar(-factor));
}

export const upY = new Vector3(0, 1, 0);
export const upZ = new Vector3(0, 0, 1);

/** What is up where nobody has said so: most files of these kinds have y up; in engineering, and in scenes, z is up. */
export const usualUp = (names: readonly string[]): Vector3 =>
  names.every((name) => /\.(obj|gltf|glb)$/i.test(name)) ? upY : upZ;

const halfHeight = 0.5;
const margin = 1.12; // around what is looked at
const turnStep = Math.PI / 24;
const moveStep = 0.06; // of the view's height
const zoomStep = 1.2;
const arrows: Record<string, readonly [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

export class Viewer {
  readonly host: HTMLElement;
  private readonly renderer: WebGLRenderer | undefined;
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera();
  private readonly isFlat: boolean;
  private readonly callbacks: (() => void)[] = [];
  private controls: OrbitControls;
  private isRequested = false;
  private width = 1;
  private height = 1;

  /**
   * `host` holds the view and gets the keys; what it has inside stays above the picture. A view that is flat has no
   * picture, only what lies above it, and is not turned.
   */
  constructor(host: HTMLElement, up: Vector3, isFlat = false) {
    this.host = host;
    this.isFlat = isFlat;
    this.renderer = isFlat ? undefined : rendererIn(host);
    this.controls = this.madeControls(up);
    host.addEventListener('keydown', (event) => this.press(event));
    // The controls tell of changes, but not of those that are small for who has not zoomed in.
    host.addEventListener('pointermove', ({ buttons }) => buttons !== 0 && this.request());
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  get up(): Vector3 {
    return this.camera.up;
  }

  /** The view is as it was until it is told where to look. */
  setUp(up: Vector3): void {
    this.controls.dispose();
    this.controls = this.madeControls(up);
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
  lookAt(center: Vector3, radius: number, from?: Vector3): void {
    const away = from?.clone() ?? this.camera.position.clone().sub(this.controls.target);
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(away.normalize(), 2);
    this.camera.zoom = (halfHeight * Math.min(1, this.width / this.height)) / Math.max(radius, 1e-7);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.controls.saveState();
    this.request();
  }

  /** Looks at a point, as large and from the same direction as now. */
  moveTo(center: Vector3): void {
    this.camera.position.add(center).sub(this.controls.target);
    this.controls.target.copy(center);
    this.controls.update();
    this.request();
  }

  /** Looks at boxes from a direction, so that they fill the view. */
  lookAtBoxes(boxes: readonly Box3[], from: Vector3): void {
    this.lookAt(new Vector3(), halfHeight, from);
    this.camera.updateMatrixWorld();
    const seen = new Box3();
    for (const box of boxes) seen.union(box.clone().applyMatrix4(this.camera.matrixWorldInverse));
    const [center, size] = [seen.getCenter(new Vector3()).setZ(0), seen.getSize(new Vector3())];
    const aspect = this.width / this.height;
    const radius = Math.max(size.x / Math.max(1, aspect), size.y / Math.max(1, 1 / aspect)) / 2;
    this.lookAt(center.applyQuaternion(this.camera.quaternion), radius * margin, from);
  }

  /** Where a point of the frame is on the view, in pixels from its upper left corner. */
  project(p: Vector3): [number, number] {
    const clip = p.clone().project(this.camera);
    return [((clip.x + 1) / 2) * this.width, ((1 - clip.y) / 2) * this.height];
  }

  /** From where the view looks, as a direction of the frame. */
  get from(): Vector3 {
    return this.camera.getWorldDirection(new Vector3()).negate();
  }

  /** How long a pixel is, in the frame. */
  get pixel(): number {
    return (2 * halfHeight) / this.camera.zoom / this.height;
  }

  get size(): [number, number] {
    return [this.width, this.height];
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

  private madeControls(up: Vector3): OrbitControls {
    this.camera.up.copy(up);
    const controls = new OrbitControls(this.camera, this.host);
    controls.zoomToCursor = true;
    controls.minZoom = 0.2;
    controls.maxZoom = 1e6;
    if (this.isFlat) {
      controls.enableRotate = false;
      controls.mouseButtons.LEFT = MOUSE.PAN;
      controls.touches = { ONE: TOUCH.PAN, TWO: TOUCH.DOLLY_PAN };
    }
    controls.addEventListener('change', () => this.request());
    return controls;
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    const narrowBefore = Math.min(1, this.width / this.height);
    [this.width, this.height] = [clientWidth, clientHeight];
    const aspect = this.width / this.height;
    Object.assign(this.camera, { left: -halfHeight * aspect, right: halfHeight * aspect });
    Object.assign(this.camera, { top: halfHeight, bottom: -halfHeight });
    const factor = Math.min(1, aspect) / narrowBefore;
    this.camera.zoom *= factor;
    this.controls.zoom0 *= factor; // where 0 goes back to
    this.camera.updateProjectionMatrix();
    this.renderer?.setSize(this.width, this.height, false);
    this.request();
  }

  private press(event: KeyboardEvent): void {
    if (event.target !== this.host || event.ctrlKey || event.metaKey || event.altKey) return;
    const { controls } = this;
    const [right, up] = arrows[event.key] ?? [0, 0];
    if (event.key in arrows && (event.shiftKey || this.isFlat)) {
      controls.pan(-right * moveStep * this.height, up * moveStep * this.height);
    } else if (event.key in arrows) {
      controls.rotateLeft(right * turnStep);
      controls.rotateUp(up * turnStep);
    } else if (event.key === '+' || event.key === '=') controls.dollyIn(1 / zoomStep);
    else if (event.key === '-') controls.dollyOut(1 / zoomStep);
    else if (event.key === '0') controls.reset();
    else return;
    event.preventDefault();
    this.request();
  }
}

function rendererIn(host: HTMLElement): WebGLRenderer | undefined {
  const canvas = element('canvas');
  host.prepend(canvas);
  const context = canvas.getContext('webgl2', { alpha: true, antialias: true, preserveDrawingBuffer: true });
  if (context === null) {
    host.append(element('p', 'no-view', 'This browser has no WebGL, so no 3D view.'));
    return undefined;
  }
  const renderer = new WebGLRenderer({ canvas, context, alpha: true });
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  return renderer;
}
