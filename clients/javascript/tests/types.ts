// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The declarations of the package: compiled by tsc --strict, never run. What is expected to fail, must.
import * as limber from "limber3d";
import type { CollideResult, Contact, DistanceResult, ElementImpact, ErrorCode, Impact, ImpactResult, PathDistance,
  PathImpact, Point, Pose, SignedDistance } from "limber3d";

const vertices = new Float32Array(9), faces = new Uint32Array(3);
const a = new limber.Model(vertices, faces, { motionMargin: 0.01, rebuildPolicy: "off", rebuildBudgetUs: 50 });
const b: limber.Model = new limber.Model([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);

// What three.js has, without its types.
const matrix4 = { elements: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] };
const vector3 = { x: 0, y: 0, z: 1 }, quaternion = { x: 0, y: 0, z: 0, w: 1 };
const poses: Pose[] = [matrix4, matrix4.elements, new Float64Array(16), { translation: vector3 },
  { quaternion, translation: [0, 0, 1] }, { rotation: new Float64Array(9) }, { quaternion: [0, 0, 0, 1] }];

const cache = new limber.QueryCache();
const near: DistanceResult = limber.distance(a, b, { poseA: poses[0], poseB: null, relativeError: 0.1, cache });
const point: Point | undefined = near.witness?.pointA;
const meets: CollideResult = limber.collide(a, b, { cache });
const soon: CollideResult = limber.collide(a, b, { budget: { deadline: performance.now() + 1, maxSteps: 100 } });
const isWithin: boolean = limber.within(a, b, 1).answer === "yes";
const maybe: "no" | "yes" | "undecided" = limber.within(a, b, 1, { budget: {} }).answer;
const rings = new limber.NeighborRings(a, 1);
const found: Contact[] = [...limber.selfContacts(a, 0.1, { filter: rings, maxCount: 5 })];
const ids: Uint32Array = limber.intersections(a, b, { filter: (s: number, t: number) => s < t }).triangles;
const depth: number | undefined = limber.closestPoint(a, vector3, { pose: poses[3] }).closest?.distance;
const inside: boolean = new limber.ClosedSurface(a).contains([0, 0, 0]);
const file: limber.MeshFile = limber.readMeshBytes(new Uint8Array(0), "mesh.obj");
const started: Promise<void> = limber.init(new URL("https://example.org/limber.wasm"));
const code: ErrorCode = new limber.LimberError("notRigid", "no", 1).code;
a.moveVertices([0], vertices);
a.commit();
const spheres: Float64Array = a.nodeSpheres(0);
rings.dispose();
const moving = new limber.MovingModel(a);
moving.setMotion(vertices, { startPose: poses[0], endPose: null });
const edges: Uint32Array = a.edges();
const touching: ImpactResult = limber.timeOfImpact(moving, moving, { separationFraction: 0.1, anyContact: true });
const element: number | undefined = limber.selfTimeOfImpact(moving, { budget: { maxSteps: 9 } }).elements?.a;
const impacts: Impact[] = [...limber.impacts(moving, moving, { timeError: 1e-6, maxCount: 5 })];
const motionA = new limber.RigidMotion(poses[0], poses[1], vector3), screw = limber.RigidMotion.screw(null, poses[2]);
const onPath: PathImpact = limber.timeOfImpact(a, b, { motionA, motionB: screw, minSeparation: 0.1, cache });
const nearest: PathDistance = limber.minDistance(a, b, { motionA, distanceError: 0.1 });
const placed: Pose = motionA.at(0.5);
const crossed: ElementImpact = limber.edgeEdgeImpact(new Float64Array(12), new Float64Array(12), { minSeparation: 1 });

const surface = new limber.ClosedSurface(a);
const relation: limber.SolidRelation = limber.solidRelation(surface, surface, { poseB: poses[0] }).relation;
const body: limber.SolidDistance = limber.signedDistance(surface, surface, { relativeError: 0.1, budget: {} });
const deepest: number | undefined = body.deepest.ofA?.closest.triangle;
const moment: Point = limber.poseGradientB(limber.contactOf(a, b, near.witness!), vector3).moment;
const weldedOf: Uint32Array = limber.weld(vertices, faces).weldedOf;
const scene = new limber.Scene(), counts = new limber.ObjectPairMatrix(2), sceneCache = new limber.SceneCache();
const id: number = scene.add(a, poses[0]);
const uppers: Float64Array = scene.distance(scene.candidatePairs(1), { relativeError: 0.1, cache: sceneCache }).uppers;
const pair: [number, number] | null = scene.closestObjects({ filter: counts, cache: sceneCache }).objects;
const close: CollideResult[] = [...scene.anyWithinMany([id], new Float64Array(32), 0, { filter: (m, n) => m < n })];

const shape: limber.Shape = limber.Shape.box(vector3, 0.1), floor = limber.Shape.heightField(vertices, 3, 3, 1, 1);
const bodies: limber.Body[] = [a, shape, limber.Shape.cylinder([0, 0, 0], vector3, 1, 0.01)];
const gap: number = limber.distance(bodies[0], floor).upper + shape.deviation;
const offsets: Uint32Array = scene.contacts([id, id], 0.1, { orientedFaces: "both" }).offsets;
const closest: number | null = scene.closestObject(shape, { pose: null, filter: (other) => other > 1 }).object;

const inners: SignedDistance[] = [...surface.signedDistanceMany(vertices)].filter((one) => one.isInside);
const side: "unknown" | "outward" | "inward" = limber.normalSides[limber.contacts(a, b, 1).normalSides[0]];

// @ts-expect-error names do not change
limber.answers[0] = "yes";
// @ts-expect-error how results are read is private
scene.collide([]).common(0);
// @ts-expect-error nothing may be close
limber.closestPoint(a, vector3).closest.distance;
// @ts-expect-error shapes do not change
shape.radius = 1;
// @ts-expect-error shapes are made by functions
new limber.Shape(1);
// @ts-expect-error a shape has no mesh of its own
limber.closestPoint(shape, vector3);
// @ts-expect-error vertices are numbers
new limber.Model("vertices", faces);
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
// @ts-expect-error surfaces, not models
limber.solidRelation(a, b);
// @ts-expect-error rings are of triangles
scene.closestObjects({ filter: rings });
// @ts-expect-error nothing may touch
touching.elements.kind;

export { close, closest, code, crossed, deepest, depth, edges, element, file, found, gap, ids, impacts, inners, inside,
  isWithin, maybe, meets, moment, nearest, offsets, onPath, pair, placed, point, relation, side, soon, spheres, started,
  uppers, weldedOf, wrong };
