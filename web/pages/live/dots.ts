// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** Dots of a few pixels, seen through what lies before them. */

import { BufferAttribute, BufferGeometry, Color, GLSL3, Points, ShaderMaterial } from 'three';

const vertexShader = `
uniform float pixels;
void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = pixels;
}`;

const fragmentShader = `
precision highp float;
uniform vec3 color;
uniform vec3 rim;
out vec4 result;
void main() {
  float off = length(gl_PointCoord - 0.5);
  if (off > 0.5) discard;
  result = vec4(mix(color, rim, 0.7 * smoothstep(0.3, 0.45, off)), 1.0);
}`;

export class Dots {
  readonly object: Points;
  private readonly uniforms = {
    color: { value: new Color() },
    rim: { value: new Color() },
    pixels: { value: 6 * Math.min(devicePixelRatio, 2) },
  };
  private readonly geometry = new BufferGeometry();

  constructor() {
    const material = new ShaderMaterial({ vertexShader, fragmentShader, uniforms: this.uniforms, glslVersion: GLSL3 });
    material.depthTest = false;
    this.object = new Points(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    this.show(new Float32Array());
  }

  /** Three coordinates each. */
  show(points: Float32Array): void {
    const shown = this.geometry.getAttribute('position') as BufferAttribute | undefined;
    if (shown !== undefined && shown.array.length >= points.length) {
      shown.array.set(points);
      shown.needsUpdate = true;
    } else {
      this.geometry.dispose();
      const room = new Float32Array(2 * points.length);
      room.set(points);
      this.geometry.setAttribute('position', new BufferAttribute(room, 3));
    }
    this.geometry.setDrawRange(0, points.length / 3);
  }

  setColors(color: readonly [number, number, number], rim: readonly [number, number, number]): void {
    this.uniforms.color.value.setRGB(...color);
    this.uniforms.rim.value.setRGB(...rim);
  }
}
