#!/usr/bin/env python3
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Other libraries from PyPI on the questions of `./dev bench contacts`: pairs of triangles that intersect or are close,
and closest points. Each answers on one core. Writes contact_peers.csv, and on demand the answers. See README.md."""

import os

# One core, before any library counts them: TBB, OpenMP and thread pools all start one thread then.
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")

# pylint: disable=wrong-import-position
import argparse
import csv
import gc
import importlib.metadata
import importlib.util
import itertools
import pathlib
import statistics
import time

import numpy as np

import meshes

MARGIN = 1e-3  # of the diagonal of the bounding box
NAMED = {"cloth": "cloth_ball_92.ply", "bunny": "stanford-bunny.obj", "armadillo": "armadillo.obj"}
CLOTH_VERTICES, CLOTH_TRIANGLES = 46216, 91470  # of cloth_ball_92.ply and 93; the rest is a coarse ball below the cloth
POINTS = 10_000


class Comparison:
    """Takes times, and keeps them and the answers."""

    def __init__(self, options):
        self.runs, self.answers, self.rows = options.runs, options.answers, []
        if self.answers:
            self.answers.mkdir(parents=True, exist_ok=True)

    def note(self, peer, mesh, question, details, us="", count=""):
        """Keeps one row, and shows it."""
        self.rows.append([peer, mesh, question, us, count, details])
        print(",".join(str(value) for value in self.rows[-1]), flush=True)

    def time(self, peer, mesh, question, call, *, count=None, details="", answer=None, prepare=None):
        """The median time of call(). An untimed answer(), call() unless given, comes first; it is counted and returned.
        prepare() runs before each call, untimed. Runs end early after two seconds, but not before the third run, or
        after ten."""
        if prepare:
            prepare()
        found = (answer or call)()
        taken, used = [], []
        gc.disable()
        while len(taken) < self.runs and sum(taken) < (10 if len(taken) < 3 else 2):
            if prepare:
                prepare()
            begin, used_before = time.perf_counter(), time.process_time()
            result = call()
            used.append(time.process_time() - used_before)
            taken.append(time.perf_counter() - begin)
            del result  # outside the time
        gc.enable()
        times = f"least={1e6 * min(taken):.1f} us; processor={1e6 * statistics.median(used):.1f} us; runs={len(taken)}"
        details = f"{details}; {times}" if details else times
        self.note(peer, mesh, question, details, f"{1e6 * statistics.median(taken):.1f}",
                  int(found if count is None else count(found)))
        return found

    def save(self, name, rows):
        """Writes an answer, sorted, a line for each row: numbers apart by blanks, reals with all digits."""
        if self.answers:
            lines = (" ".join(f"{v:.17g}" if isinstance(v, float) else str(v) for v in row) for row in sorted(rows))
            (self.answers / f"{name}.txt").write_text("".join(line + "\n" for line in lines), encoding="ascii")

    def save_mesh(self, name, mesh):
        """Writes a mesh that was made here, for programs that ask the same questions."""
        if self.answers:
            meshes.write_ply(self.answers / f"{name}.ply", mesh)


class MeshLib:
    """MeshLib computes with float coordinates, which it converts to double for a pair of triangles."""

    def __init__(self, comparison):
        import meshlib.mrmeshnumpy as numpy_bridge
        import meshlib.mrmeshpy as library
        self.c, self.library, self.bridge = comparison, library, numpy_bridge

    def mesh(self, mesh):
        """MeshLib's mesh. Its face ids are those of the triangles."""
        return self.bridge.meshFromFacesVerts(mesh[1], mesh[0])

    def self_pairs(self, name, mesh):
        """All pairs of triangles of one mesh that intersect: strictly, and with touching ones."""
        built = self.mesh(mesh)
        kept = f"faces={built.topology.numValidFaces()} of {len(mesh[1])}"
        self.c.time("meshlib", name, "build", built.getAABBTree, prepare=built.invalidateCaches,
                    count=lambda _: len(mesh[1]), details="AABB tree")
        part, details = self.library.MeshPart(built), f"tree is ready; {kept}"
        self.c.time("meshlib", name, "self_pairs_touching", count=len, details=details, call=lambda:
                    self.library.findSelfCollidingTriangles(part, touchIsIntersection=True))
        found = self.c.time("meshlib", name, "self_pairs", count=len, details=details, call=lambda:
                            self.library.findSelfCollidingTriangles(part, touchIsIntersection=False))
        self.c.save(f"meshlib_{name}_self_pairs", [sorted((p.aFace.get(), p.bFace.get())) for p in found])

    def pairs(self, name, a, b):
        """All pairs of triangles of two meshes that intersect."""
        parts = [self.library.MeshPart(self.mesh(mesh)) for mesh in (a, b)]
        found = self.c.time("meshlib", name, "pairs", lambda: self.library.findCollidingTriangles(*parts), count=len,
                            details="trees are ready")
        self.c.save(f"meshlib_{name}_pairs", [(p.aFace.get(), p.bFace.get()) for p in found])

    def points(self, name, mesh, kind, points):
        """Closest points of many points in one call."""
        projector, found = self.library.PointsToMeshProjector(), self.library.std_vector_MeshProjectionResult()
        built, given = self.mesh(mesh), self.bridge.fromNumpyArray(points)
        projector.updateMeshData(built)
        self.c.time("meshlib", name, f"points_{kind}", count=lambda _: len(found), details="PointsToMeshProjector",
                    call=lambda: projector.findProjections(found, given, None, None, 3e38, 0))
        self.c.save(f"meshlib_{name}_points_{kind}", [(i, float(p.distSq) ** 0.5) for i, p in enumerate(found)])


class Ipc:
    """The IPC Toolkit. Its boxes are inflated by a radius each, so pairs within d need a radius of d / 2."""

    phases = ("LBVH", "HashGrid", "SpatialHash", "SweepAndPrune")

    def __init__(self, comparison):
        import ipctk
        ipctk.set_num_threads(1)
        self.c, self.library = comparison, ipctk

    def mesh(self, mesh):
        """What the toolkit needs, without vertices that no triangle has; `ids` has the ids in the file of the rest."""
        ids, corners = np.unique(mesh[1], return_inverse=True)
        positions, faces = mesh[0][ids], corners.reshape(-1, 3).astype(np.int32)
        positions, faces = np.asfortranarray(positions), np.asfortranarray(faces)
        edges = np.asfortranarray(self.library.edges(faces))
        return self.library.CollisionMesh(positions, edges, faces), positions, edges, faces, ids

    def candidates(self, built, positions, radius, phase="LBVH"):
        """Pairs of elements whose inflated boxes overlap and that share no vertex."""
        found = self.library.Candidates()
        found.build(built, positions, radius, getattr(self.library, phase)())
        return found

    def collisions(self, candidates, built, positions, margin):
        """What is within the margin, by the kind of its closest elements, each pair of elements once."""
        found = self.library.NormalCollisions()
        found.build(candidates, built, positions, margin)
        return found

    def within(self, name, candidates, mesh, margin):
        """Counts and saves candidates that are truly within the margin. Not timed: a call from Python for each."""
        _, positions, edges, faces, ids = mesh
        ends, limit = ids[edges], margin * margin
        edge_pairs, face_vertices = [], []
        for pair in candidates.ee_candidates:
            found = pair.compute_distance(positions, edges, faces)
            if found <= limit:
                both = sorted(tuple(sorted(ends[e].tolist())) for e in (pair.edge0_id, pair.edge1_id))
                edge_pairs.append((*both[0], *both[1], found ** 0.5))
        for pair in candidates.fv_candidates:
            found = pair.compute_distance(positions, edges, faces)
            if found <= limit:
                face_vertices.append((pair.face_id, int(ids[pair.vertex_id]), found ** 0.5))
        self.c.note("ipctk", name, "within", f"edge_edge={len(edge_pairs)}; face_vertex={len(face_vertices)}",
                    count=len(edge_pairs) + len(face_vertices))
        self.c.save(f"ipctk_{name}_edge_edge", edge_pairs)
        self.c.save(f"ipctk_{name}_face_vertex", face_vertices)

    def intersects(self, name, mesh):
        """Whether an edge meets a face that it shares no vertex with."""
        built, positions, *_ = self.mesh(mesh)
        for phase in self.phases:
            self.c.time("ipctk", name, "has_intersections", details=phase, call=lambda:
                        self.library.has_intersections(built, positions, getattr(self.library, phase)()))

    def self_candidates(self, name, mesh):
        """Candidates of one mesh by each broad phase, and their distances."""
        made = self.mesh(mesh)
        built, positions, edges, faces, _ = made
        elements = len(positions) + len(edges) + len(faces)
        for phase, factor in itertools.product(self.phases, (0.5, 1)):
            radius, broad = factor * MARGIN * meshes.diagonal(mesh), getattr(self.library, phase)()
            setting = f"{phase}; inflation={factor * MARGIN:g} of the size"
            self.c.time("ipctk", name, "build", details=setting, count=lambda _: elements, call=lambda:
                        broad.build(positions, edges, faces, radius))
            found = self.candidates(built, positions, radius, phase)
            kinds = f"edge_edge={len(found.ee_candidates)}; face_vertex={len(found.fv_candidates)}"
            self.c.time("ipctk", name, "candidates", details=f"{setting}; with build; {kinds}", count=len, call=lambda:
                        self.candidates(built, positions, radius, phase))
            if phase == "LBVH" and factor == 0.5:
                self.c.time("ipctk", name, "distances", count=len, details="NormalCollisions.build", call=lambda:
                            self.collisions(found, built, positions, 2 * radius))
                self.within(name, found, made, 2 * radius)

    def frame(self, name, cloths, body):
        """One frame: the cloth has moved, all of it; it, with itself and with a body at rest, within the margin.
        `cloths` has two states of the cloth, which take turns."""
        margin, made = MARGIN * meshes.diagonal(cloths[0]), self.mesh(meshes.joined(cloths[0], body))
        built, first, _, _, ids = made
        built.can_collide = self.library.make_static_obstacle_filter(int(np.searchsorted(ids, len(cloths[0][0]))))
        second = np.asfortranarray(meshes.joined(cloths[1], body)[0][ids])
        state = itertools.cycle((second, first))

        def whole(positions):
            return self.collisions(self.candidates(built, positions, margin / 2), built, positions, margin)

        found = self.candidates(built, first, margin / 2)
        kinds = f"edge_edge={len(found.ee_candidates)}; face_vertex={len(found.fv_candidates)}"
        self.c.time("ipctk", name, "frame_candidates", details=f"LBVH; with build; {kinds}", count=len, answer=lambda:
                    found, call=lambda: self.candidates(built, next(state), margin / 2))
        self.c.time("ipctk", name, "frame", count=len, details="LBVH; build, candidates and distances", answer=lambda:
                    whole(first), call=lambda: whole(next(state)))
        self.within(name, found, made, margin)


class Coal:
    """Coal: pairs of triangles of two models. It has no question about one model with itself."""

    def __init__(self, comparison):
        import coal
        self.c, self.library = comparison, coal

    def model(self, mesh, kind):
        """A hierarchy of bounding volumes."""
        built = getattr(self.library, f"BVHModel{kind}")()
        built.beginModel(len(mesh[1]), len(mesh[0]))
        built.addVertices(mesh[0])
        built.addTriangles(mesh[1].astype(np.int64))
        built.endModel()
        return built

    def pairs(self, name, a, b, margins):
        """All pairs within margins, which are (name, length)."""
        here = self.library.Transform3s.Identity()
        for kind, (label, margin) in itertools.product(("OBBRSS", "OBB"), margins):
            one, other, request = self.model(a, kind), self.model(b, kind), self.library.CollisionRequest()
            request.num_max_contacts, request.security_margin = 10_000_000, margin

            def ask():
                result = self.library.CollisionResult()
                self.library.collide(one, here, other, here, request, result)
                return result

            found = self.c.time("coal", name, f"pairs_{label}", ask, count=lambda r: r.numContacts(),
                                details=f"{kind}; margin={margin:g}; models are ready")
            self.c.save(f"coal_{name}_pairs_{label}_{kind}",
                        [(pair.b1, pair.b2, float(pair.penetration_depth)) for pair in found.getContacts()])


def fcpw_points(comparison, name, mesh, kind, points):
    """Closest points of many points in one call. FCPW computes with float."""
    import fcpw
    scene, found = fcpw.scene_3D(), fcpw.interaction_3D_list()
    scene.set_object_count(1)
    scene.set_object_vertices(np.asfortranarray(mesh[0], np.float32), 0)
    scene.set_object_triangles(np.asfortranarray(mesh[1]), 0)
    scene.build(fcpw.aggregate_type.bvh_surface_area, True)
    given, radii = np.asfortranarray(points, np.float32), np.full(len(points), 3e38, np.float32)
    comparison.time("fcpw", name, f"points_{kind}", details="wide BVH, surface area", count=lambda _: len(found), call=
                    lambda: scene.find_closest_points(given, radii, found, False), prepare=found.clear)
    comparison.save(f"fcpw_{name}_points_{kind}", [(i, float(hit.d)) for i, hit in enumerate(found)])


def trimesh_points(comparison, name, mesh, kind, points):
    """Closest points of many points in one call."""
    import trimesh
    built = trimesh.Trimesh(*mesh, process=False)
    found = comparison.time("trimesh", name, f"points_{kind}", count=lambda f: len(f[1]), details="closest_point", call=
                            lambda: trimesh.proximity.closest_point(built, points))
    comparison.save(f"trimesh_{name}_points_{kind}", [(i, float(d)) for i, d in enumerate(found[1])])


def query_points(mesh):
    """Points anywhere in the bounding box, made half as large again, and points within a hundredth of the size of the
    surface. Each is a float, so that every peer is asked about the same points."""
    random, low, high = np.random.default_rng(0x5EED0020), mesh[0].min(axis=0), mesh[0].max(axis=0)
    box = low + (high - low) * random.uniform(-0.25, 1.25, (POINTS, 3))
    corners = mesh[0][mesh[1][random.integers(len(mesh[1]), size=POINTS)]]
    near = np.einsum("nc,ncd->nd", random.dirichlet((1, 1, 1), POINTS), corners)
    near += 0.01 * meshes.diagonal(mesh) / 3 ** 0.5 * random.uniform(-1, 1, (POINTS, 3))
    return {kind: points.astype(np.float32).astype(float) for kind, points in (("anywhere", box), ("near", near))}


def compare(comparison, folder, peers):
    """Asks all questions."""
    scans = {name: meshes.read(folder / file) for name, file in NAMED.items()}
    later = meshes.read(folder / "cloth_ball_93.ply")
    drapes = [(mesh[0][:CLOTH_VERTICES], mesh[1][:CLOTH_TRIANGLES]) for mesh in (scans["cloth"], later)]
    ball = meshes.ball((0, 6.6765, 0), 5.115, 51, 100)
    folded, body = [meshes.folded_cloth(phase) for phase in (0, 1)], meshes.ball((0, 0, 0), 1, 51, 100)
    for name, mesh in {"drape": drapes[0], "drape_moved": drapes[1], "drape_ball": ball, "folded": folded[0],
                       "folded_moved": folded[1], "folded_ball": body}.items():
        comparison.save_mesh(name, mesh)
    if "meshlib" in peers:
        meshlib = MeshLib(comparison)
        for name, mesh in {**scans, "folded": folded[0]}.items():
            meshlib.self_pairs(name, mesh)
        meshlib.pairs("drape", drapes[0], ball)
    if "ipctk" in peers:
        ipc = Ipc(comparison)
        for name, mesh in scans.items():
            ipc.intersects(name, mesh)
            ipc.self_candidates(name, mesh)
        ipc.frame("frame_folded", folded, body)
        ipc.frame("frame_drape", drapes, ball)
    if "coal" in peers:
        coal = Coal(comparison)
        for name, a, b in (("drape", drapes[0], ball), ("folded", folded[0], body)):
            margins = [("0", 0.0), ("margin", MARGIN * meshes.diagonal(a))] + [("0.01", 0.01)] * (name == "drape")
            coal.pairs(name, a, b, margins)
    for kind, points in query_points(scans["bunny"]).items():
        comparison.save(f"points_{kind}", [(i, *point) for i, point in enumerate(points.tolist())])
        if "fcpw" in peers:
            fcpw_points(comparison, "bunny", scans["bunny"], kind, points)
        if "meshlib" in peers:
            meshlib.points("bunny", scans["bunny"], kind, points)
        if "trimesh" in peers:
            trimesh_points(comparison, "bunny", scans["bunny"], kind, points)


def processor():
    """The processor's name."""
    lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace").splitlines()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown")


def main():
    """Reads the options, compares, writes the table."""
    known = ("meshlib", "ipctk", "coal", "fcpw", "trimesh")
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", type=pathlib.Path, help=f"folder with {', '.join(NAMED.values())}, cloth_ball_93.ply")
    parser.add_argument("--out", type=pathlib.Path, help="folder for contact_peers.csv")
    parser.add_argument("--answers", type=pathlib.Path, help="folder for the answers and for meshes made here")
    parser.add_argument("--runs", type=int, default=15, help="runs of each call (15), fewer of long ones")
    parser.add_argument("--peers", nargs="+", choices=known, default=known, help="only these")
    options = parser.parse_args()
    peers = [peer for peer in options.peers if importlib.util.find_spec(peer)]
    comparison = Comparison(options)
    comparison.note("machine", "", "processor", processor())
    for peer in options.peers:
        comparison.note(peer, "", "version", importlib.metadata.version(peer) if peer in peers else "not installed")
    compare(comparison, options.meshes, peers)
    if options.out:
        options.out.mkdir(parents=True, exist_ok=True)
        with open(options.out / "contact_peers.csv", "w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(("peer", "mesh", "question", "us_median", "count", "details"))
            writer.writerows(comparison.rows)


if __name__ == "__main__":
    main()
