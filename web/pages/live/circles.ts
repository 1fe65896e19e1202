// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** The outlines of spheres, as an orthographic view shows them: circles that face the reader. */

import {
  BufferAttribute,
  Color,
  GLSL3,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  LineSegments,
  ShaderMaterial,
} from 'three';

const vertexShader = `
in vec4 sphere;
void main() {
  vec4 center = modelViewMatrix * vec4(sphere.xyz, 1.0);
  gl_Position = projectionMatrix * (center + vec4(position.xy * sphere.w, 0.0, 0.0));
}`;

const fragmentShader = `
precision highp float;
uniform vec3 color;
uniform float opacity;
out vec4 result;
void main() { result = vec4(color, opacity); }`;

const corners = 48;

export class Circles {
  readonly object: LineSegments;
  private readonly uniforms = { color: { value: new Color() }, opacity: { value: 1 } };
  private readonly geometry = new InstancedBufferGeometry();

  constructor() {
    const ring = new Float32Array(6 * corners);
    for (let i = 0; i < corners; ++i) {
      for (const end of [0, 1]) {
        const angle = (2 * Math.PI * (i + end)) / corners;
        ring.set([Math.cos(angle), Math.sin(angle), 0], 6 * i + 3 * end);
      }
    }
    this.geometry.setAttribute('position', new BufferAttribute(ring, 3));
    this.show(new Float32Array());
    const material = new ShaderMaterial({ vertexShader, fragmentShader, uniforms: this.uniforms, glslVersion: GLSL3 });
    material.transparent = true;
    material.depthWrite = false;
    this.object = new LineSegments(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.matrixAutoUpdate = false;
  }

  /** Center and radius of each. */
  show(spheres: Float32Array): void {
    const count = spheres.length / 4;
    const shown = this.geometry.getAttribute('sphere') as InstancedBufferAttribute | undefined;
    if (shown !== undefined && shown.array.length === spheres.length) {
      shown.array.set(spheres);
      shown.needsUpdate = true;
    } else {
      this.geometry.dispose(); // the buffers on the graphics card; those of the new size are made when it is drawn
      this.geometry.setAttribute('sphere', new InstancedBufferAttribute(spheres, 4));
    }
    this.geometry.instanceCount = count;
    this.uniforms.opacity.value = count > 200 ? 0.4 : 0.85;
  }

  setColor(rgb: readonly [number, number, number]): void {
    this.uniforms.color.value.setRGB(...rgb);
  }
}
