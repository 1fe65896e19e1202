// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What is drawn besides surfaces, all in one colour: dots, the outlines of spheres, and lines on a sheet. */

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  GLSL3,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  LineSegments,
  Points,
  ShaderMaterial,
} from 'three';

type Rgb = readonly [number, number, number];

/** A material of one colour, with an opacity. */
function materialOf(vertexShader: string, color = 'result = vec4(color, opacity);'): ShaderMaterial {
  const material = new ShaderMaterial({
    vertexShader,
    fragmentShader: `precision highp float;
      uniform vec3 color;
      uniform vec3 rim;
      uniform float opacity;
      out vec4 result;
      void main() { ${color} }`,
    uniforms: { color: { value: new Color() }, rim: { value: new Color() }, opacity: { value: 1 } },
    glslVersion: GLSL3,
  });
  material.transparent = true;
  return material;
}

/** Writes numbers into an attribute on the graphics card, which is made anew where it is too small. */
function write(geometry: BufferGeometry, name: string, made: BufferAttribute): void {
  const shown = geometry.getAttribute(name) as BufferAttribute | undefined;
  if (shown !== undefined && shown.array.length >= made.array.length) {
    shown.array.set(made.array);
    shown.needsUpdate = true;
  } else {
    geometry.dispose();
    geometry.setAttribute(name, made);
  }
}

/** Dots of a few pixels, seen through what lies before them. */
export class Dots {
  readonly object: Points;
  private readonly geometry = new BufferGeometry();
  private readonly material = materialOf(
    `void main() {
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      gl_PointSize = ${(6 * Math.min(devicePixelRatio, 2)).toFixed(1)};
    }`,
    `float off = length(gl_PointCoord - 0.5);
    if (off > 0.5) discard;
    result = vec4(mix(color, rim, 0.7 * smoothstep(0.3, 0.45, off)), 1.0);`,
  );

  constructor() {
    this.material.depthTest = false;
    this.object = new Points(this.geometry, this.material);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    this.show(new Float32Array());
  }

  /** Three coordinates each. */
  show(points: Float32Array): void {
    write(this.geometry, 'position', new BufferAttribute(points, 3));
    this.geometry.setDrawRange(0, points.length / 3);
  }

  setColors(color: Rgb, rim: Rgb): void {
    this.material.uniforms.color.value.setRGB(...color);
    this.material.uniforms.rim.value.setRGB(...rim);
  }
}

const cornersOfCircle = 48;

/** The outlines of spheres, as an orthographic view shows them: circles that face the reader. */
export class Circles {
  readonly object: LineSegments;
  private readonly geometry = new InstancedBufferGeometry();
  private readonly material = materialOf(`in vec4 sphere;
    void main() {
      vec4 center = modelViewMatrix * vec4(sphere.xyz, 1.0);
      gl_Position = projectionMatrix * (center + vec4(position.xy * sphere.w, 0.0, 0.0));
    }`);

  constructor() {
    const ring = Array.from({ length: 2 * cornersOfCircle }, (_, i) => {
      const angle = (2 * Math.PI * Math.ceil(i / 2)) / cornersOfCircle;
      return [Math.cos(angle), Math.sin(angle), 0];
    });
    this.geometry.setAttribute('position', new BufferAttribute(Float32Array.from(ring.flat()), 3));
    this.material.depthWrite = false;
    this.object = new LineSegments(this.geometry, this.material);
    this.object.frustumCulled = false;
    this.object.matrixAutoUpdate = false;
    this.show(new Float32Array(), [0, 0, 0]);
  }

  /** Center and radius of each. */
  show(spheres: Float32Array, color: Rgb): void {
    write(this.geometry, 'sphere', new InstancedBufferAttribute(spheres, 4));
    const count = spheres.length / 4;
    this.geometry.instanceCount = count;
    this.material.uniforms.color.value.setRGB(...color);
    this.material.uniforms.opacity.value = count > 200 ? 0.4 : 0.85;
  }
}

/** Every tenth line of the grid of a square sheet, so that its shape is seen. */
export class Grid {
  readonly object: LineSegments;
  private readonly material = materialOf(`void main() {
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      gl_Position.z -= 0.0015;
    }`);

  constructor(positions: BufferAttribute) {
    const side = Math.sqrt(positions.count);
    const lines: number[] = [];
    for (let line = 0; line < side; line += 10) {
      for (let i = 0; i + 1 < side; ++i) {
        lines.push(line * side + i, line * side + i + 1, i * side + line, (i + 1) * side + line);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', positions);
    geometry.setIndex(new BufferAttribute(Uint32Array.from(lines), 1));
    this.material.uniforms.opacity.value = 0.55;
    this.object = new LineSegments(geometry, this.material);
    this.object.frustumCulled = false;
  }

  setColor(color: Rgb): void {
    this.material.uniforms.color.value.setRGB(...color);
  }
}
