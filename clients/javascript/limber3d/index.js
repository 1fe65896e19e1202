// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

/**
 * Collision and distance for triangle meshes that deform.
 *
 *     import { Model, distance, init } from "limber3d";
 *     await init();
 *     const model = new Model(vertices, faces);
 *     const result = distance(model, other, { poseB: mesh.matrixWorld, relativeError: 0.01 });
 *     model.moveAll(newVertices);
 *     model.commit();
 *
 * @module
 */

export { closestPairs, Contacts, contacts, featureKinds, intersections, NeighborRings } from "./contacts.js";
export { normalSides } from "./contacts.js";
export { selfClosestPairs, selfCollide, selfContacts, selfDistance, selfIntersections } from "./contacts.js";
export { edgeEdgeImpact, impactStatuses, vertexFaceImpact } from "./elements.js";
export { LimberError } from "./errors.js";
export { contactOf, poseGradientA, poseGradientB, vertexGradientsA, vertexGradientsB } from "./gradients.js";
export { noId } from "./many.js";
export { Model, readMeshBytes, weld } from "./model.js";
export { elementPairKinds, Impacts, impacts, MovingModel, selfImpacts, selfTimeOfImpact } from "./motion.js";
export { timeOfImpact } from "./motion.js";
export { minDistance, RigidMotion } from "./path.js";
export { closestPoint, closestPointMany, ClosedSurface, PointResults, SignedDistances } from "./points.js";
export { orthonormalized } from "./poses.js";
export { answers, collide, distance, distanceStatuses, QueryCache, stoppedBys, within } from "./queries.js";
export { Scene } from "./scene.js";
export { ObjectPairMatrix, SceneCache } from "./scene_options.js";
export { CollideResults, DistanceResults } from "./scene_results.js";
export { Shape } from "./shapes.js";
export { deepestVertices, separatingTranslation, signedDistance, solidRelation } from "./solids.js";
export { init } from "./wasm.js";

/**
 * @typedef {import("./arrays.js").Coordinates} Coordinates
 * @typedef {import("./arrays.js").Ids} Ids
 * @typedef {import("./arrays.js").Point} Point
 * @typedef {import("./arrays.js").Vector} Vector
 * @typedef {import("./contacts.js").Contact} Contact
 * @typedef {import("./contacts.js").CountOptions} CountOptions
 * @typedef {import("./contacts.js").Feature} Feature
 * @typedef {import("./contacts.js").MaxDistanceOptions} MaxDistanceOptions
 * @typedef {import("./contacts.js").NormalSide} NormalSide
 * @typedef {import("./contacts.js").OrientedFacesOptions} OrientedFacesOptions
 * @typedef {import("./contacts.js").PairOptions} PairOptions
 * @typedef {import("./contacts.js").SelfPairOptions} SelfPairOptions
 * @typedef {import("./contacts.js").TrianglePairFilter} TrianglePairFilter
 * @typedef {import("./contacts.js").TrianglePairs} TrianglePairs
 * @typedef {import("./elements.js").ElementImpact} ElementImpact
 * @typedef {import("./elements.js").ElementImpactOptions} ElementImpactOptions
 * @typedef {import("./elements.js").ImpactStatus} ImpactStatus
 * @typedef {import("./errors.js").ErrorCode} ErrorCode
 * @typedef {import("./gradients.js").PoseGradient} PoseGradient
 * @typedef {import("./model.js").MeshFile} MeshFile
 * @typedef {import("./model.js").MaintenanceStats} MaintenanceStats
 * @typedef {import("./model.js").ModelOptions} ModelOptions
 * @typedef {import("./model.js").TreeStats} TreeStats
 * @typedef {import("./model.js").WeldedMesh} WeldedMesh
 * @typedef {import("./motion.js").ElementPair} ElementPair
 * @typedef {import("./motion.js").FirstImpactOptions} FirstImpactOptions
 * @typedef {import("./motion.js").Impact} Impact
 * @typedef {import("./motion.js").ImpactOptions} ImpactOptions
 * @typedef {import("./motion.js").ImpactResult} ImpactResult
 * @typedef {import("./path.js").PathDistance} PathDistance
 * @typedef {import("./path.js").PathImpact} PathImpact
 * @typedef {import("./path.js").PathImpactOptions} PathImpactOptions
 * @typedef {import("./path.js").PathOptions} PathOptions
 * @typedef {import("./points.js").PointOptions} PointOptions
 * @typedef {import("./points.js").PointResult} PointResult
 * @typedef {import("./points.js").SignedDistance} SignedDistance
 * @typedef {import("./points.js").SurfacePoint} SurfacePoint
 * @typedef {import("./poses.js").Matrix} Matrix
 * @typedef {import("./poses.js").Pose} Pose
 * @typedef {import("./poses.js").Quaternion} Quaternion
 * @typedef {import("./queries.js").Answer} Answer
 * @typedef {import("./queries.js").CollideResult} CollideResult
 * @typedef {import("./queries.js").DistanceOptions} DistanceOptions
 * @typedef {import("./queries.js").DistanceResult} DistanceResult
 * @typedef {import("./queries.js").ErrorOptions} ErrorOptions
 * @typedef {import("./queries.js").PoseOptions} PoseOptions
 * @typedef {import("./queries.js").QueryBudget} QueryBudget
 * @typedef {import("./queries.js").QueryOptions} QueryOptions
 * @typedef {import("./queries.js").QueryStats} QueryStats
 * @typedef {import("./queries.js").DistanceStatus} DistanceStatus
 * @typedef {import("./queries.js").StoppedBy} StoppedBy
 * @typedef {import("./queries.js").Witness} Witness
 * @typedef {import("./scene.js").AnyWithinResult} AnyWithinResult
 * @typedef {import("./scene.js").ClosestObjectResult} ClosestObjectResult
 * @typedef {import("./scene.js").ClosestObjectsResult} ClosestObjectsResult
 * @typedef {import("./scene.js").ObjectContacts} ObjectContacts
 * @typedef {import("./scene.js").ObjectImpactResult} ObjectImpactResult
 * @typedef {import("./scene.js").ObjectImpactOptions} ObjectImpactOptions
 * @typedef {import("./scene.js").SceneQueryOptions} SceneQueryOptions
 * @typedef {import("./scene_options.js").Matrices} Matrices
 * @typedef {import("./scene_options.js").ObjectPairFilter} ObjectPairFilter
 * @typedef {import("./scene_options.js").ObjectFilter} ObjectFilter
 * @typedef {import("./scene_options.js").ObjectPairOptions} ObjectPairOptions
 * @typedef {import("./shapes.js").Body} Body
 * @typedef {import("./solids.js").DeepestPair} DeepestPair
 * @typedef {import("./solids.js").DeepestVertex} DeepestVertex
 * @typedef {import("./solids.js").DeepestVertices} DeepestVertices
 * @typedef {import("./solids.js").DeepestVerticesOptions} DeepestVerticesOptions
 * @typedef {import("./solids.js").SolidDistanceOptions} SolidDistanceOptions
 * @typedef {import("./solids.js").SeparatingTranslation} SeparatingTranslation
 * @typedef {import("./solids.js").SeparatingTranslationOptions} SeparatingTranslationOptions
 * @typedef {import("./solids.js").SolidDistance} SolidDistance
 * @typedef {import("./solids.js").SolidRelation} SolidRelation
 * @typedef {import("./solids.js").SolidRelationResult} SolidRelationResult
 */
