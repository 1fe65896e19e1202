// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The declarations of the package: compiled by tsc --strict, never run. What is expected to fail, must.
import * as limber from "limber3d";
import type { Body, CollideResult, Contact, DistanceResult, ErrorCode, ImpactResult, Point, Pose, RigidImpactResult,
  SignedDistance } from "limber3d";

const vertices = new Float32Array(9), faces = new Uint32Array(3);
const a = new limber.Model(vertices, faces, { motionMargin: 0.01, rebuildPolicy: "off" });
const b: limber.Model = new limber.Model([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);

// What three.js has, without its types.
const matrix4 = { elements: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] };
const vector3 = { x: 0, y: 0, z: 1 }, quaternion = { x: 0, y: 0, z: 0, w: 1 };
const poses: Pose[] = [matrix4, matrix4.elements, new Float64Array(16), { translation: vector3 },
  { quaternion, translation: [0, 0, 1] }, { rotation: new Float64Array(9) }, { quaternion: [0, 0, 0, 1] }];

const cache = new limber.QueryCache(), rings = new limber.NeighborRings(a, 1);
const near: DistanceResult = limber.distance(a, b, { poseA: poses[0], poseB: null, relativeError: 0.1, cache });
const point: Point | undefined = near.witness?.pointA;
const soon: CollideResult = limber.collide(a, b, { budget: { deadline: performance.now() + 1 } });
const maybe: "no" | "yes" | "undecided" = limber.within(a, b, 1, { budget: {} }).answer;
const found: Contact[] = [...limber.selfContacts(a, 0.1, { filter: rings, maxCount: 5 })];
const side: limber.NormalSide = limber.normalSides[limber.contacts(a, b, 1).normalSides[0]];
const depth: number | undefined = limber.closestPoint(a, vector3, { pose: poses[3] }).closest?.distance;
const surface = new limber.ClosedSurface(a), inside: boolean = surface.contains([0, 0, 0]);
const inners: SignedDistance[] = [...surface.signedDistanceMany(vertices)].filter((one) => one.isInside);
const started: Promise<void> = limber.init(new URL("https://example.org/limber.wasm"));
const code: ErrorCode = new limber.LimberError("notRigid", "no", 1).code;

const moving = new limber.MovingModel(a), edges: Uint32Array = a.edges();
moving.setMotion(vertices, { startPose: poses[0], endPose: null });
const touching: ImpactResult = limber.timeOfImpact(moving, moving, { separationFraction: 0.1, anyContact: true });
const element: number | undefined = limber.selfTimeOfImpact(moving, { budget: { maxSteps: 9 } }).elements?.a;
const motionA = new limber.RigidMotion(poses[0], poses[1], vector3), placed: Pose = motionA.at(0.5);
const onPath: RigidImpactResult = limber.timeOfImpact(a, b, { motionA, minSeparation: 0.1, distanceError: 0.1, cache });

const shape: limber.Shape = limber.Shape.box(vector3, 0.1);
const bodies: Body[] = [a, shape, limber.Shape.convexHull(vertices)];
const gap: number = limber.distance(bodies[0], shape).upper;
const scene = new limber.Scene();
const id: number = scene.add(a, poses[0]);
const uppers: Float64Array = scene.distance(scene.candidatePairs(1), { relativeError: 0.1 }).uppers;
const pair: [number, number] | null = scene.closestObjects({ ignoredPairs: [id, 3] }).objects;

// @ts-expect-error names do not change
limber.answers[0] = "yes";
// @ts-expect-error shapes do not change
shape.radius = 1;
// @ts-expect-error a shape has no mesh of its own
limber.closestPoint(shape, vector3);
// @ts-expect-error there is no worker
new limber.Model(vertices, faces, { rebuildPolicy: "onWorker" });
// @ts-expect-error the option is called relativeError
limber.distance(a, b, { relative_error: 0.1 });
// @ts-expect-error a pose is no number
limber.distance(a, b, { poseA: 1 });
// @ts-expect-error the answer may be undecided, so it is no boolean
limber.collide(a, b).collision;
// @ts-expect-error models are no caches
limber.distance(a, b, { cache: a });
// @ts-expect-error rings are of one model
limber.contacts(a, b, 1, { filter: rings });
// @ts-expect-error the witness may be missing
near.witness.pointA;
// @ts-expect-error there is no such code
const wrong: ErrorCode = "not_rigid";
// @ts-expect-error two moving models, or two models
limber.timeOfImpact(a, moving);
// @ts-expect-error moving models have no motion but their own
limber.timeOfImpact(moving, moving, { motionA });
// @ts-expect-error how arguments are read is private
limber.poseOf;

export { code, depth, edges, element, found, gap, inners, inside, maybe, onPath, pair, placed, point, side,
  soon, started, touching, uppers, wrong };
