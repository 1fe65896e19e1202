// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What is simpler as a few numbers than as a mesh.

import { coordinatesOf, filledFrom, numberOf, pointOf } from "./arrays.js";
import { LimberError, invalid } from "./errors.js";
import { Model, addressOf } from "./model.js";
import { Owner, engine, number, ownedAddress, word, writeInput } from "./wasm.js";
/** @import { Coordinates, Vector } from "./arrays.js" */

/**
 * What queries of two bodies are about.
 *
 * @typedef {Model | Shape} Body
 */

/**
 * A shape: all points that are at most a radius from its core, a few triangles; of a solid also all points that these
 * enclose. Functions of two bodies, and scenes, take shapes as they take models. A shape does not change.
 *
 * Functions that make one throw invalidArgument unless all lengths, coordinates and radii are finite, at most 2 ** 200
 * in size and, where they are sizes, >= 0. Its memory belongs to the module, as that of a model: dispose() frees it.
 */
export class Shape extends Owner {
  /**
   * Whether the core's surface is closed, and what it encloses belongs to the shape.
   *
   * @readonly
   */
  isSolid;

  /**
   * How far points of the shape are from the core at most, but for the inside of solids.
   *
   * @readonly
   */
  radius;

  /**
   * At most how far points of the shape are from what was asked for, which is inside of it: the true distance is
   * between `lower` and `upper + deviation`, up to rounding. 0 for all shapes but cylinders.
   *
   * @readonly
   */
  deviation;

  /**
   * Private: made by the functions below, of what the module has just made.
   *
   * @private
   * @param {number} address
   */
  constructor(address) {
    if (typeof address !== "number") throw invalid("a Shape is made by functions such as Shape.sphere()");
    super(address, "deleteBody");
    this.isSolid = word(0) === 1;
    this.radius = number(0);
    this.deviation = number(1);
  }

  /** A ball around the origin. @param {number} radius */
  static sphere(radius) {
    return new Shape(engine().newSphere(numberOf(radius, "radius")));
  }

  /**
   * All points at most `radius` from a segment.
   *
   * @param {Vector} start
   * @param {Vector} end
   * @param {number} radius
   */
  static capsule(start, end, radius) {
    const ends = endsOf(start, end), size = numberOf(radius, "radius");
    writeInput(ends);
    return new Shape(engine().newCapsule(size));
  }

  /**
   * A solid box around the origin. With a radius, all points that are at most that far from it: a larger box with round
   * edges.
   *
   * @param {Vector} halfExtents
   * @param {number} [radius] 0 if not given
   */
  static box(halfExtents, radius) {
    const extents = pointOf(halfExtents, "halfExtents");
    return new Shape(engine().newBox(...extents, numberOf(radius, "radius", 0)));
  }

  /**
   * A solid cylinder: all points at most `radius` from a segment, between the planes across its ends. It is
   * approximated by the prism around it with the fewest sides whose points are at most `maxError` from it, but for
   * rounding. So no collision is missed, and the distance may be too small by `deviation`.
   *
   * Throws also unless the segment is longer than 0, radius and maxError are above 0, and 65 536 sides suffice.
   *
   * @param {Vector} start
   * @param {Vector} end
   * @param {number} radius
   * @param {number} maxError
   */
  static cylinder(start, end, radius, maxError) {
    const ends = endsOf(start, end), size = numberOf(radius, "radius"), error = numberOf(maxError, "maxError");
    writeInput(ends);
    return new Shape(engine().newCylinder(size, error));
  }

  /**
   * All points p with dot(normal, p) <= offset, where the normal is first scaled to length 1. It is cut to a solid
   * cube, whose face in the plane is a square around the point nearest to the origin, with sides of 2 * `halfExtent`.
   * Rounding moves the plane by about 2 ** -51 of the half extent and the offset.
   *
   * Throws also unless the normal is not 0, and the half extent is above 0.
   *
   * @param {Vector} normal
   * @param {number} offset
   * @param {number} halfExtent
   */
  static halfSpace(normal, offset, halfExtent) {
    const along = pointOf(normal, "normal"), at = numberOf(offset, "offset");
    return new Shape(engine().newHalfSpace(...along, at, numberOf(halfExtent, "halfExtent")));
  }

  /**
   * The convex hull of some points, a solid; or a flat polygon, a segment or a point, where the points leave no more.
   * With a radius, all points that are at most that far from it. It is exactly the hull, and its corners are points.
   *
   * Throws also unless there is a point. Cost: O(n h) for h triangles of the hull.
   *
   * @param {Coordinates} points
   * @param {number} [radius] 0 if not given
   */
  static convexHull(points, radius) {
    const coordinates = coordinatesOf(points, "points"), size = numberOf(radius, "radius", 0);
    writeInput(coordinates);
    return new Shape(engine().newConvexHull(...countOf(coordinates), size));
  }

  /**
   * A surface over a grid in the x-y plane: the height at (column * stepX, row * stepY) is
   * heights[row * columns + column]. It is a surface, with nothing below; a radius makes it thicker.
   *
   * Throws sizeMismatch unless there are columns * rows heights; invalidArgument also unless there are at least two
   * columns and rows, and steps are above 0.
   *
   * @param {Float32Array | Float64Array | readonly number[]} heights
   * @param {number} columns
   * @param {number} rows
   * @param {number} stepX
   * @param {number} stepY
   * @param {number} [radius] 0 if not given
   */
  static heightField(heights, columns, rows, stepX, stepY, radius) {
    const isArray = heights instanceof Float32Array || heights instanceof Float64Array || Array.isArray(heights);
    if (!isArray) throw invalid("heights is no Float32Array, Float64Array or array of numbers");
    const all = filledFrom(new Float64Array(heights.length), heights, "heights");
    if (!(Number.isInteger(columns) && Number.isInteger(rows) && columns * rows === all.length)) {
      throw new LimberError("sizeMismatch", `limber3d: heights has ${all.length} numbers, not columns * rows`);
    }
    const sizes = [numberOf(stepX, "stepX"), numberOf(stepY, "stepY"), numberOf(radius, "radius", 0)];
    writeInput(all);
    return new Shape(engine().newHeightField(columns, rows, ...sizes));
  }

  /**
   * All points at most `radius` from one of some points: balls of one size. Triangle i of witnesses and contacts is
   * point i. Throws also unless there is a point.
   *
   * @param {Coordinates} points
   * @param {number} radius
   */
  static pointCloud(points, radius) {
    const coordinates = coordinatesOf(points, "points"), size = numberOf(radius, "radius");
    writeInput(coordinates);
    return new Shape(engine().newPointCloud(...countOf(coordinates), size));
  }
}

/** The ends of a segment, as the module reads them. @param {Vector} start @param {Vector} end */
const endsOf = (start, end) => Float64Array.of(...pointOf(start, "start"), ...pointOf(end, "end"));

/** How many points there are, and whether they are float32. @param {Float32Array | Float64Array} coordinates */
const countOf = (coordinates) => [coordinates.length / 3, coordinates instanceof Float32Array ? 1 : 0];

/**
 * Where a model or a shape is in the module's memory. Private to the package.
 *
 * @param {Body} body
 * @param {string} name of the argument
 */
export function bodyAddress(body, name) {
  if (body instanceof Shape) return ownedAddress(body, name);
  if (!(body instanceof Model)) throw invalid(`${name} is no Model or Shape`);
  return addressOf(body, name);
}
