// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/** What the page asks the engine in each frame, and how long that takes. */

import { Model, NeighborRings, QueryCache, contacts, distance, selfContacts } from '../../limber3d/index.js';
import type { Contacts, DistanceResult } from '../../limber3d/index.js';
import type { BodyPose } from './body.ts';
import type { TriangleMesh } from './hare.ts';
import { Sheet } from './sheet.ts';

export interface Questions {
  relativeError: number;
  /** Nothing if contacts are not asked for. */
  contactMargin: number | undefined;
  selfContacts: boolean;
}

/** In milliseconds. */
export interface EngineTimes {
  update: number;
  distance: number;
  contacts: number | undefined;
  selfContacts: number | undefined;
}

export interface Answers {
  distance: DistanceResult;
  contacts: Contacts | undefined;
  selfContacts: Contacts | undefined;
  times: EngineTimes;
}

const mostContacts = 10000;
const selfMargin = 0.8 * Sheet.squareWidth;
const ringEdges = 2; // triangles that near along the sheet are no self-contacts, though within the margin

export class Engine {
  sheet: Model;
  body: Model;
  private readonly rings: NeighborRings;
  private cache = new QueryCache();
  private lastError = 0;

  constructor(sheet: Sheet, body: TriangleMesh) {
    this.sheet = modelOf(sheet);
    this.rings = new NeighborRings(this.sheet, ringEdges);
    this.body = new Model(body.vertices, body.faces);
  }

  /**
   * Builds the sheet's model from where it is now, and forgets earlier answers. The next answer then has the bits of
   * any program that builds both models from these meshes. Trees and caches with a history may find another of several
   * equally close pairs, whose distance differs in its last bits.
   */
  forgetHistory(sheet: Sheet): void {
    const model = modelOf(sheet);
    this.sheet.dispose();
    this.sheet = model;
    this.cache.clear();
  }

  /** Throws what the engine finds wrong with the mesh; the body is then as before. */
  replaceBody(mesh: TriangleMesh): void {
    const body = new Model(mesh.vertices, mesh.faces);
    this.body.dispose();
    this.body = body;
    this.cache.dispose();
    this.cache = new QueryCache();
  }

  /** Moves the sheet, unless its positions are those of the last call, and asks. */
  ask(positions: Float64Array | undefined, pose: BodyPose, questions: Questions): Answers {
    const { relativeError, contactMargin } = questions;
    // The cache knows better bounds than a larger error asks for; the answer is to show what was asked for.
    if (relativeError !== this.lastError) this.cache.clear();
    this.lastError = relativeError;
    const started = performance.now();
    if (positions !== undefined) {
      this.sheet.moveAll(positions);
      this.sheet.commit();
    }
    const updated = performance.now();
    const found = distance(this.sheet, this.body, { poseB: pose, relativeError, cache: this.cache });
    const measured = performance.now();
    const touching =
      contactMargin === undefined
        ? undefined
        : contacts(this.sheet, this.body, contactMargin, { poseB: pose, maxCount: mostContacts });
    const touched = performance.now();
    const folded = questions.selfContacts
      ? selfContacts(this.sheet, selfMargin, { filter: this.rings, maxCount: mostContacts })
      : undefined;
    const ended = performance.now();
    return {
      distance: found,
      contacts: touching,
      selfContacts: folded,
      times: {
        update: updated - started,
        distance: measured - updated,
        contacts: touching && touched - measured,
        selfContacts: folded && ended - touched,
      },
    };
  }
}

function modelOf(sheet: Sheet): Model {
  return new Model(sheet.positions, sheet.faces, { preallocate: true });
}
