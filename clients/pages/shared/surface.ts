// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A mesh in 3D: flat triangles in one colour. */

import { BufferAttribute, BufferGeometry, Color, DoubleSide, GLSL3, LinearSRGBColorSpace, Mesh } from 'three';
import { ShaderMaterial, Vector3, Vector4 } from 'three';
import type { Matrix4 } from 'three';
import { token } from './dom.ts';

const vertexShader = `
out vec3 seen;
out vec3 placed;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vec4 view = viewMatrix * world;
  placed = world.xyz;
  seen = view.xyz;
  gl_Position = projectionMatrix * view;
}`;

// Flat shading: the normal is that of the triangle, whichever side is seen.
const fragmentShader = `
precision highp float;
uniform vec3 color;
uniform vec4 relief;
uniform float opacity;
in vec3 seen;
in vec3 placed;
out vec4 result;
void main() {
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float light = abs(dot(normal, normalize(vec3(0.28, 0.36, 0.89))));
  vec3 own = color;
  if (relief.xyz != vec3(0.0)) {
    float height = clamp(1.5 * (dot(placed, relief.xyz) - relief.w) - 0.25, 0.0, 1.0);
    own = height < 0.5 ? color * (0.44 + 1.12 * height) : mix(color, vec3(1.0), 1.1 * height - 0.55);
  }
  // What is seen through is clearer where it is seen from the front, as a bubble is.
  float cover = opacity < 1.0 ? opacity * mix(2.6, 0.4, sqrt(abs(normal.z))) : 1.0;
  result = vec4(own * (0.55 + 0.5 * light), cover);
}`;

function materialOf(): ShaderMaterial {
  const uniforms = { color: { value: new Color() }, relief: { value: new Vector4() }, opacity: { value: 1 } };
  return new ShaderMaterial({ vertexShader, fragmentShader, uniforms, side: DoubleSide, glslVersion: GLSL3 });
}

/** Triangles over vertices that others may share. */
export function geometryOf(positions: BufferAttribute, corners: Uint32Array): BufferGeometry {
  return new BufferGeometry().setAttribute('position', positions).setIndex(new BufferAttribute(corners, 1));
}

export class Surface {
  readonly object = new Mesh(undefined, materialOf());
  private readonly marked = new Mesh(new BufferGeometry(), materialOf());

  constructor() {
    for (const drawn of [this.object, this.marked]) drawn.frustumCulled = false;
    this.object.matrixAutoUpdate = false;
    this.object.add(this.marked);
    Object.assign(this.marked.material, { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
  }

  /** Shows triangles where a matrix places them. */
  show(geometry: BufferGeometry, matrix: Matrix4): void {
    this.object.geometry = geometry;
    this.object.matrix.copy(matrix);
  }

  /** Draws some of the triangles once more, in a colour of their own, and those before no more. */
  mark(triangles: readonly number[]): void {
    const { index, attributes } = this.object.geometry;
    const corners = triangles.flatMap((t) => [...index!.array.slice(3 * t, 3 * t + 3)]);
    this.marked.geometry.dispose();
    this.marked.geometry = geometryOf(attributes.position as BufferAttribute, Uint32Array.from(corners));
  }

  /** Lets what is behind show through, where it is below 1. */
  setOpacity(opacity: number): void {
    const { material } = this.object;
    material.uniforms.opacity.value = opacity;
    material.transparent = opacity < 1;
    material.depthWrite = opacity === 1;
  }

  /** Colours of page.css: of all, and of what is marked. */
  setColors(own: string, marked: string): void {
    this.object.material.uniforms.color.value.setStyle(token(own), LinearSRGBColorSpace);
    this.marked.material.uniforms.color.value.setStyle(token(marked), LinearSRGBColorSpace);
  }

  /** Makes what is high lighter than what is low, along a direction of the frame. */
  shadeByHeight(up: Vector3, low: number, high: number): void {
    const range = high > low ? high - low : 1;
    this.object.material.uniforms.relief.value.set(...up.toArray(), low).divideScalar(range);
  }

  /** The vertex that lies farthest in a direction, as placed. */
  farthestAlong(along: Vector3): Vector3 {
    const { geometry, matrix } = this.object;
    const { array } = geometry.attributes.position;
    const turned = along.clone().transformDirection(matrix.clone().transpose());
    let [best, most] = [0, -Infinity];
    for (let i = 0; i < array.length; i += 3) {
      const reached = turned.x * array[i] + turned.y * array[i + 1] + turned.z * array[i + 2];
      if (reached > most) [best, most] = [i, reached];
    }
    return new Vector3().fromArray(array, best).applyMatrix4(matrix);
  }
}
