// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * A view in 3D that is turned, moved and zoomed by mouse, touch and keyboard. The projection is orthographic: lengths
 * across the view are true to scale. A picture is drawn only where something has changed.
 */

import { Box3, Matrix4, OrthographicCamera, Scene, Vector3, WebGLRenderer } from 'three';
import type { Object3D } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { element } from './dom.ts';

/** From the world to what views draw: a box whose diagonal becomes 1, around the origin, which float32 resolves. */
export function frameOf(box: Box3): Matrix4 {
  const size = Math.hypot(...box.getSize(new Vector3()));
  const factor = size > 0 ? 1 / size : 1;
  const center = box.getCenter(new Vector3());
  return new Matrix4().makeScale(factor, factor, factor).setPosition(center.multiplyScalar(-factor));
}

export const upY = new Vector3(0, 1, 0);
export const upZ = new Vector3(0, 0, 1);

/** What is up where nobody has said so: most files of these kinds have y up; in engineering, and in scenes, z is up. */
export const usualUp = (names: readonly string[]): Vector3 =>
  names.every((name) => /\.(obj|gltf|glb)$/i.test(name)) ? upY : upZ;

const halfHeight = 0.5;
const margin = 1.12; // around what is looked at
const zoomStep = 1.2;

export class Viewer {
  readonly host: HTMLElement;
  private readonly renderer: WebGLRenderer | undefined;
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera();
  private readonly callbacks: (() => void)[] = [];
  private controls: OrbitControls;
  private isRequested = false;
  private width = 1;
  private height = 1;

  /** `host` holds the view and gets the keys; what it has inside stays above the picture. */
  constructor(host: HTMLElement, up: Vector3) {
    this.host = host;
    this.renderer = rendererIn(host);
    this.controls = this.madeControls(up);
    host.addEventListener('keydown', (event) => this.zoomBy(event));
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
  lookAt(center: Vector3, radius: number, from = this.from): void {
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(from.clone().normalize(), 2);
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

  get size(): [number, number] {
    return [this.width, this.height];
  }

  private draw(): void {
    // The frame's objects lie within 1 of its center: the planes that bound the view are as tight as that allows.
    this.camera.updateMatrixWorld();
    const ahead = -this.from.dot(this.camera.position);
    Object.assign(this.camera, { near: -ahead - 1, far: -ahead + 1 });
    this.camera.updateProjectionMatrix();
    this.renderer?.render(this.scene, this.camera);
    for (const callback of this.callbacks) callback();
  }

  private madeControls(up: Vector3): OrbitControls {
    this.camera.up.copy(up);
    const controls = new OrbitControls(this.camera, this.host);
    Object.assign(controls, { zoomToCursor: true, minZoom: 0.2, maxZoom: 1e6, keyPanSpeed: 30, keyRotateSpeed: 10 });
    controls.listenToKeyEvents(this.host);
    controls.addEventListener('change', () => this.request());
    return controls;
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    const narrowBefore = Math.min(1, this.width / this.height);
    [this.width, this.height] = [clientWidth, clientHeight];
    const aspect = this.width / this.height;
    const [right, top] = [halfHeight * aspect, halfHeight];
    Object.assign(this.camera, { left: -right, right, top, bottom: -top });
    const factor = Math.min(1, aspect) / narrowBefore;
    this.camera.zoom *= factor;
    this.controls.zoom0 *= factor; // where 0 goes back to
    this.camera.updateProjectionMatrix();
    this.renderer?.setSize(this.width, this.height, false);
    this.request();
  }

  /** The controls know arrow keys alone. */
  private zoomBy(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === '+' || event.key === '=') this.controls.dollyIn(1 / zoomStep);
    else if (event.key === '-') this.controls.dollyOut(1 / zoomStep);
    else if (event.key === '0') this.controls.reset();
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
