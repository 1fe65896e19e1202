// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** A mesh in 3D: flat triangles in one colour, or in the colours of a map. */

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DoubleSide,
  GLSL3,
  LinearFilter,
  Mesh as ThreeMesh,
  Object3D,
  ShaderMaterial,
  Sphere,
  Vector3,
  Vector4,
} from 'three';
import type { Matrix4 } from 'three';
import { rgbOf } from './dom.ts';

export interface Mesh {
  points: Float32Array;
  corners: Uint32Array;
}

/**
 * The colours of the map from near to far, in equal steps: from bright yellow to dark blue, through grey. Lightness
 * decreases in equal steps, and yellow turns into blue, so that readers who do not tell red from green, or see no
 * colours at all, read the same order. The idea is that of cividis [Nunez2018]; these were computed in Oklab
 * [Ottosson2020].
 */
export const mapColors = (
  '#ffd640 #f3ce4e #dfc559 #cbbc60 #b9b367 #a6a96b #959f6f #849572 #758b74 ' +
  '#668075 #587676 #4c6a76 #415f76 #365375 #2e4773 #263b72 #202d6f'
).split(' ');

const vertexShader = `
in float mapped;
out float value;
out vec3 seen;
out vec3 placed;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vec4 view = viewMatrix * world;
  value = mapped;
  placed = world.xyz;
  seen = view.xyz;
  gl_Position = projectionMatrix * view;
}`;

// Flat shading: the normal is that of the triangle, whichever side is seen.
const fragmentShader = `
precision highp float;
uniform vec3 color;
uniform vec3 lineColor;
uniform sampler2D table;
uniform bool isMapped;
uniform vec2 range;
uniform float lineStep;
uniform float limit;
uniform bool isCut;
uniform vec4 plane;
uniform vec4 relief;
uniform float opacity;
in float value;
in vec3 seen;
in vec3 placed;
out vec4 result;
float line(float number, float width) {
  float distance = abs(fract(number - 0.5) - 0.5) / max(fwidth(number), 1e-12);
  return 1.0 - smoothstep(width - 0.5, width + 0.5, distance);
}
void main() {
  if (isCut && dot(placed, plane.xyz) > plane.w) discard;
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float light = abs(dot(normal, normalize(vec3(0.28, 0.36, 0.89))));
  vec3 own = color;
  if (relief.xyz != vec3(0.0)) {
    float height = clamp(1.5 * (dot(placed, relief.xyz) - relief.w) - 0.25, 0.0, 1.0);
    own = height < 0.5 ? color * (0.44 + 1.12 * height) : mix(color, vec3(1.0), 1.1 * height - 0.55);
  }
  vec3 shown = own * (0.55 + 0.5 * light);
  if (isMapped) {
    float part = clamp((value - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0);
    float count = float(textureSize(table, 0).x);
    shown = texture(table, vec2((0.5 + part * (count - 1.0)) / count, 0.5)).rgb;
    shown = (value > range.y ? mix(color, vec3(0.8), 0.62) : shown) * (0.74 + 0.26 * light);
    bool hasLines = lineStep > 0.0 && value < range.y && fwidth(value) < 0.5 * lineStep;
    if (hasLines) shown *= 1.0 - 0.35 * line(value / lineStep, 0.6);
    if (limit > 0.0) {
      float off = abs(value - limit) / max(fwidth(value), 1e-12);
      shown = mix(lineColor, shown, smoothstep(1.0, 2.0, off));
    }
  }
  // What is seen through is clearer where it is seen from the front, as a bubble is.
  result = vec4(shown, opacity < 1.0 ? opacity * mix(2.6, 0.4, sqrt(abs(normal.z))) : 1.0);
}`;

function geometryOf(mesh: Mesh, mapped: Float32Array): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(mesh.points, 3));
  geometry.setAttribute('mapped', new BufferAttribute(mapped, 1));
  geometry.setIndex(new BufferAttribute(mesh.corners, 1));
  geometry.boundingSphere = new Sphere(new Vector3(), Infinity);
  return geometry;
}

/** What all surfaces of a page share: how they are coloured and cut. */
export class SurfaceLook {
  readonly isMapped = { value: false };
  /** In the unit of the mapped numbers. */
  readonly range = { value: [0, 1] };
  readonly lineStep = { value: 0 };
  readonly limit = { value: 0 };
  readonly lineColor = { value: new Color() };
  readonly isCut = { value: false };
  readonly plane = { value: new Vector4() };
  readonly table: { value: DataTexture };

  constructor() {
    const bytes = mapColors.flatMap((color) => [...rgbOf(color), 1].map((c) => Math.round(255 * c)));
    const texture = new DataTexture(Uint8Array.from(bytes), mapColors.length, 1);
    texture.minFilter = LinearFilter;
    texture.magFilter = LinearFilter;
    texture.needsUpdate = true;
    this.table = { value: texture };
  }

  /** Hides what is beyond the plane of the points p with normal . p = offset. */
  cutAt(normal: Vector3, offset: number): void {
    this.plane.value.set(...normal.toArray(), offset);
  }
}

export class Surface {
  readonly object: Object3D;
  readonly mesh: Mesh;
  private readonly geometry: BufferGeometry;
  private readonly color = { value: new Color() };
  private readonly relief = { value: new Vector4() };
  private readonly look: SurfaceLook;
  private readonly ownMaterial: ShaderMaterial;
  private marked: Object3D | undefined;

  /** `mapped`: a number for each vertex. */
  constructor(mesh: Mesh, look: SurfaceLook, mapped?: Float32Array, geometry?: BufferGeometry) {
    this.mesh = mesh;
    this.look = look;
    this.geometry = geometry ?? geometryOf(mesh, mapped ?? new Float32Array(mesh.points.length / 3));
    this.ownMaterial = this.material({ ...this.uniforms(), color: this.color, relief: this.relief });
    this.object = new ThreeMesh(this.geometry, this.ownMaterial);
  }

  /** The same mesh once more, with a colour and a place of its own. It must not deform. */
  twin(): Surface {
    return new Surface(this.mesh, this.look, undefined, this.geometry);
  }

  /** Lets what is behind show through, where it is below 1. */
  setOpacity(opacity: number): void {
    this.ownMaterial.uniforms.opacity.value = opacity;
    this.ownMaterial.transparent = opacity < 1;
    this.ownMaterial.depthWrite = opacity === 1;
  }

  setColor(rgb: readonly [number, number, number]): void {
    this.color.value.setRGB(...rgb);
  }

  /** Makes what is high lighter than what is low, along a direction of the frame. */
  shadeByHeight(up: Vector3, low: number, high: number): void {
    const range = high > low ? high - low : 1;
    this.relief.value.set(...up.toArray(), low).divideScalar(range);
  }

  /** Tells that `mesh.points` has changed. */
  pointsHaveMoved(): void {
    this.geometry.getAttribute('position').needsUpdate = true;
  }

  /** Places the mesh. */
  place(matrix: Matrix4): void {
    this.object.matrixAutoUpdate = false;
    this.object.matrix.copy(matrix);
  }

  /** The vertex that lies farthest in a direction, as placed. */
  farthestAlong(along: Vector3): Vector3 {
    const { points } = this.mesh;
    const turned = along.clone().transformDirection(this.object.matrix.clone().transpose());
    let best = 0;
    let most = -Infinity;
    for (let i = 0; i < points.length; i += 3) {
      const reached = turned.x * points[i] + turned.y * points[i + 1] + turned.z * points[i + 2];
      if (reached > most) [best, most] = [i, reached];
    }
    return new Vector3().fromArray(points, best).applyMatrix4(this.object.matrix);
  }

  /** Draws some of the triangles once more, in a colour of their own, and those before no more. */
  mark(triangles: readonly number[], color: { value: Color }): void {
    if (this.marked !== undefined) this.object.remove(this.marked);
    const corners = new Uint32Array(3 * triangles.length);
    triangles.forEach((t, i) => corners.set(this.mesh.corners.subarray(3 * t, 3 * t + 3), 3 * i));
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', this.geometry.getAttribute('position'));
    geometry.setAttribute('mapped', this.geometry.getAttribute('mapped'));
    geometry.setIndex(new BufferAttribute(corners, 1));
    geometry.boundingSphere = this.geometry.boundingSphere;
    const inFront = this.material({ ...this.uniforms(), isMapped: { value: false }, color });
    inFront.polygonOffset = true;
    inFront.polygonOffsetFactor = -1;
    inFront.polygonOffsetUnits = -1;
    this.marked = new ThreeMesh(geometry, inFront);
    this.object.add(this.marked);
  }

  private uniforms(): Record<string, { value: unknown }> {
    const { isMapped, range, lineStep, limit, lineColor, isCut, plane, table } = this.look;
    const relief = { value: new Vector4() };
    const opacity = { value: 1 };
    return { isMapped, range, lineStep, limit, lineColor, isCut, plane, table, relief, opacity };
  }

  private material(uniforms: Record<string, { value: unknown }>): ShaderMaterial {
    return new ShaderMaterial({ vertexShader, fragmentShader, uniforms, side: DoubleSide, glslVersion: GLSL3 });
  }
}
