# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Collision and distance for triangle meshes that deform.

    model = limber3d.Model(vertices, faces)
    result = limber3d.distance(model, other, pose_b=pose)
    model.move_all(new_vertices)
    model.commit()

Models    are made of arrays, or of an object that has them, such as a trimesh.Trimesh. Their vertices may move; after
          moves, commit() has to be called before the next query.
Shapes    limber3d.Shape.sphere(radius), capsule, box and others: wherever two bodies are asked about, and in scenes; so
          are Body(model, radius), and ClosedSurface(model).solid().
Poses     are world_from_model: None for the identity; a 4 x 4 matrix; (rotation, translation) with a 3 x 3 matrix;
          (quaternion, translation) with w, x, y, z. They must be rigid to 1e-9: for rotations that were computed in
          float32 there is orthonormalized().
Arrays    Coordinates are float32 or float64, ids are int32, int64, uint32 or uint64, with any strides. Others raise
          ValueError.
Errors    limber3d.Error where a docstring names an error code: an InputError, which is a ValueError; for
          `index_out_of_range` an OutOfRangeError, an IndexError; for `unreadable_file` an UnreadableFileError, an
          OSError. Their `code` and `where` say what was wrong, and where. BusyError where a model is changed and used
          at the same time.
Threads   Builds, commits and queries release the GIL, except queries with a filter that is a Python function. Models
          may be shared by threads that query them.
Ctrl-C    raises KeyboardInterrupt in each long call of the main thread, within a moment, also while arrays are copied;
          where there are many answers a BatchInterrupted, which keeps those that were done. Builds, changes of models,
          motions and scenes, and what else cannot be cut short, go on to their end in a thread, and what they change is
          busy until then.

Docstrings are those of the C++ library, so that some of their words are C++.
"""

from . import batch as batch
from . import typing as typing
from ._core import *
from ._core import version as __version__
from .collision_manager import CollisionManager
from .errors import Error, InputError, OutOfRangeError, UnreadableFileError
from .files import load
from .many import (
    BatchInterrupted,
    any_within_many,
    closest_objects_many,
    collide_many,
    contacts_many,
    distance_many,
    min_distance_many,
    time_of_impact_many,
    track,
    within_many,
)
from .results import (
    Contacts,
    DisplacementLimits,
    ElementPairs,
    FeaturePairs,
    ImpactCandidates,
    Impacts,
    ManyContacts,
    MeshFile,
    PoseGradient,
    ReducedContacts,
    TrianglePairs,
    WeldedMesh,
)

__all__ = [
    "Answer",
    "AnyWithinResult",
    "BatchInterrupted",
    "Body",
    "Box",
    "BusyError",
    "CancelFlag",
    "ClosedSurface",
    "ClosestObjectResult",
    "ClosestObjectsResult",
    "CollideResult",
    "CollisionManager",
    "Contacts",
    "DeepestVertex",
    "DeepestPair",
    "DeepestVertices",
    "DisplacementLimits",
    "DistanceResult",
    "DistanceStatus",
    "ElementPair",
    "ElementPairKind",
    "ElementPairs",
    "ElementState",
    "Error",
    "ErrorCode",
    "Feature",
    "FeatureKind",
    "FeaturePairs",
    "ImpactCandidates",
    "ImpactResult",
    "ImpactStatus",
    "Impacts",
    "InputError",
    "MaintenanceStats",
    "ManyContacts",
    "MeshEdges",
    "MeshFile",
    "MeshSequence",
    "Model",
    "MovingModel",
    "NeighborRings",
    "NormalSide",
    "ObjectImpactResult",
    "ObjectPairMatrix",
    "OrientedFaces",
    "OutOfRangeError",
    "PathDistance",
    "PathImpact",
    "PointResult",
    "PoseGradient",
    "QueryBudget",
    "QueryCache",
    "QueryStats",
    "RebuildPolicy",
    "ReducedContacts",
    "RigidMotion",
    "Scene",
    "SceneCache",
    "SeparatingTranslation",
    "Shape",
    "SignedDistance",
    "SolidDistance",
    "SolidRelation",
    "SolidRelationResult",
    "Sphere",
    "StoppedBy",
    "SurfacePoint",
    "TreeStats",
    "TrianglePairs",
    "UnreadableFileError",
    "WeldedMesh",
    "Witness",
    "__version__",
    "any_within_dtype",
    "any_within_many",
    "batch",
    "closest_objects_dtype",
    "closest_objects_many",
    "closest_pairs",
    "closest_point",
    "closest_point_many",
    "collide",
    "collide_dtype",
    "collide_many",
    "contact_dtype",
    "contact_of",
    "contacts",
    "contacts_many",
    "deepest_vertices",
    "distance",
    "distance_dtype",
    "distance_many",
    "edge_edge_dtype",
    "element_pair_dtype",
    "element_pairs",
    "feature_pair_dtype",
    "feature_pairs",
    "generalized_winding_number",
    "impact_candidates",
    "impact_dtype",
    "impacts",
    "intersections",
    "limit_displacements",
    "limit_motions",
    "limit_self_displacements",
    "limit_self_motions",
    "load",
    "min_distance",
    "min_distance_many",
    "orthonormalized",
    "path_distance_dtype",
    "path_impact_dtype",
    "pose_gradient_a",
    "pose_gradient_b",
    "read_mesh_file",
    "reduce_contacts",
    "self_closest_pairs",
    "self_collide",
    "self_contacts",
    "self_distance",
    "self_element_pairs",
    "self_feature_pairs",
    "self_impact_candidates",
    "self_impacts",
    "self_intersections",
    "self_state_of",
    "self_time_of_impact",
    "separating_translation",
    "set_thread_limit",
    "signed_distance",
    "signed_distance_dtype",
    "solid_relation",
    "solid_relation_dtype",
    "solid_relation_many",
    "state_of",
    "surface_point_dtype",
    "time_of_impact",
    "time_of_impact_many",
    "track",
    "typing",
    "vertex_face_dtype",
    "vertex_gradients_a",
    "vertex_gradients_b",
    "weld",
    "within",
    "within_many",
]

for _name in __all__:  # so that signatures, tracebacks and pickles name classes as users do
    if isinstance(_class := globals()[_name], type):
        _class.__module__ = __name__
