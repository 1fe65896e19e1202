# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Question        What do pairs of triangles and of elements cost that intersect or are close, of one mesh and of two,
                next to the IPC Toolkit and Coal?
Workload        A cloth that intersects itself, bunny and armadillo, each with itself. Two cloths of 100 000 triangles
                with a ball of 10 000: `drape`, through which the ball reaches, and `folded`, where nothing meets. In
                their frames every vertex of the cloth moves, and its pairs with the ball and itself are found. The
                margin is a thousandth of the size, the diagonal of the bounding box.
Metric          Microseconds a call from Python, medians on one core, by the clock and by the processor's time. Ratios
                are those of the other library to limber.
Expected shape  Several times faster than others that answer the same question. Where a mesh is close to itself
                everywhere, contacts cost what comparing their triangles costs.
Checked         Elements are those of the IPC Toolkit, and so are features with their multiplicities, once nearly parallel
                edges that it keeps for its mollifier are taken as what is closest of them; and pairs of triangles those of Coal, but for what is at the
                margin: up to a billionth of it, and up to the tolerance of Coal's GJK, a thousandth and 1e-6.

Writes contacts.md."""

from __future__ import annotations

import itertools
import sys
from collections import Counter
from collections.abc import Iterable

import measure

measure.one_core()
# ruff: noqa: E402
import coal
import ipctk
import limber3d
import numpy
from measure import Call, Mesh

MARGIN = 1e-3  # of the size
CLOTH_VERTICES, CLOTH_TRIANGLES = 46216, 91470  # of cloth_ball_92.ply and 93; the rest is a coarse ball below the cloth
ROUNDS = 15


def size_of(mesh: Mesh) -> float:
    """The diagonal of the bounding box."""
    return float(numpy.linalg.norm(mesh[0].max(axis=0) - mesh[0].min(axis=0)))


def ball(center: tuple[float, float, float], radius: float) -> Mesh:
    """A ball of 10 000 triangles: poles on the y axis, normals outward."""
    rings, sectors = 51, 100
    polar = numpy.pi * numpy.arange(1, rings)[:, None] / rings
    turn = 2 * numpy.pi * numpy.arange(sectors) / sectors
    y = numpy.broadcast_to(numpy.cos(polar), (rings - 1, sectors))
    around = numpy.stack([numpy.sin(polar) * numpy.cos(turn), y, -numpy.sin(polar) * numpy.sin(turn)], axis=-1)
    points = numpy.concatenate([[(0, 1, 0)], around.reshape(-1, 3), [(0, -1, 0)]])
    ids = 1 + numpy.arange((rings - 1) * sectors).reshape(-1, sectors)
    right, pole = numpy.roll(ids, -1, axis=1), numpy.zeros(sectors, int)
    corners = [(ids[:-1], ids[1:], right[1:]), (ids[:-1], right[1:], right[:-1]), (pole, ids[0], right[0]),
               (pole + len(points) - 1, right[-1], ids[-1])]
    faces = numpy.concatenate([numpy.stack(c, axis=-1).reshape(-1, 3) for c in corners])
    return numpy.array(center) + radius * points, faces.astype(numpy.int32)


def folded_cloth(phase: float) -> Mesh:
    """A cloth of 100 000 triangles around the upper half of a ball of radius 1 at the origin, folded once: its second
    half lies back over its first. `phase` moves every vertex. Gaps below it and between its halves open and close
    between nothing and twice the margin."""
    columns, rows, size = 250, 200, 1.8  # along the fold, across it; roughly the size
    s, y = numpy.meshgrid(numpy.arange(columns + 1) / columns, numpy.arange(rows + 1) / rows, indexing="ij")
    along = 0.7 * (1 - 4 * numpy.abs(s - 0.5)) + 0.02 * numpy.sin(phase)
    across = 1.4 * (y - 0.5)
    ripple = 1 + 0.5 * numpy.sin(9 * along + phase) * numpy.cos(8 * across - 0.7 * phase)
    radius = 1 + MARGIN * size * (0.7 * ripple + 2.2 * s)
    positions = numpy.stack([radius * numpy.sin(along) * numpy.cos(across), radius * numpy.cos(along) *
                             numpy.cos(across), radius * numpy.sin(across)], axis=-1).reshape(-1, 3)
    first = (numpy.arange(columns)[:, None] * (rows + 1) + numpy.arange(rows)).ravel()
    quads = numpy.stack([first, first + 1, first + rows + 2, first + rows + 1], axis=-1)
    return positions, numpy.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(numpy.int32)


def joined(a: Mesh, b: Mesh) -> Mesh:
    """Two meshes as one: vertices and triangles of b follow those of a."""
    return numpy.concatenate([a[0], b[0]]), numpy.concatenate([a[1], b[1] + numpy.int32(len(a[0]))])


def check(what: str, least: Iterable, found: Iterable, most: Iterable) -> None:
    """Whether an answer has all of the least answer, and nothing beyond the most."""
    answer = set(found)
    lacking, needless = set(least) - answer, answer - set(most)
    if lacking or needless:
        sys.exit(f"{what}: {len(lacking)} are only in limber's answer, {len(needless)} only in the other's")


def edge_pair(*ends: numpy.ndarray) -> tuple[tuple[int, ...], ...]:
    """Two edges by their vertices, in order."""
    return tuple(sorted(tuple(sorted(edge.tolist())) for edge in ends))


class Ipc:
    """The IPC Toolkit and a mesh. It inflates each box, so pairs within d need half of d as inflation. LBVH is its
    fastest broad phase for all of these meshes."""

    def __init__(self, mesh: Mesh, cloth_vertices: int | None = None) -> None:
        self.ids, corners = numpy.unique(mesh[1], return_inverse=True)  # it has no vertices without triangles
        self.faces = numpy.asfortranarray(corners.reshape(-1, 3).astype(numpy.int32))
        self.edges = numpy.asfortranarray(ipctk.edges(self.faces))
        self.positions = self.of(mesh[0])
        self.mesh = ipctk.CollisionMesh(self.positions, self.edges, self.faces)
        if cloth_vertices is not None:  # what follows them stands still
            self.mesh.can_collide = ipctk.make_static_obstacle_filter(int(numpy.searchsorted(self.ids, cloth_vertices)))

    def of(self, positions: numpy.ndarray) -> numpy.ndarray:
        return numpy.asfortranarray(positions[self.ids])

    def candidates(self, positions: numpy.ndarray, margin: float) -> ipctk.Candidates:
        """Pairs of elements whose inflated boxes overlap and that share no vertex."""
        found = ipctk.Candidates()
        found.build(self.mesh, positions, margin / 2, ipctk.LBVH())
        return found

    def collisions(self, positions: numpy.ndarray, margin: float) -> ipctk.NormalCollisions:
        """What is within the margin, by the kind of its closest elements."""
        found = ipctk.NormalCollisions()
        found.build(self.candidates(positions, margin), self.mesh, positions, margin)
        return found

    def elements(self, margin: float) -> set:
        """The candidates that are truly within the margin, by ids of the mesh."""
        found, where = self.candidates(self.positions, margin), (self.positions, self.edges, self.faces)
        ends, near = self.ids[self.edges], margin * margin
        pairs: set = {edge_pair(ends[p.edge0_id], ends[p.edge1_id]) for p in found.ee_candidates
                      if p.compute_distance(*where) <= near}
        return pairs | {(int(self.ids[p.vertex_id]), p.face_id) for p in found.fv_candidates
                        if p.compute_distance(*where) <= near}


    def features(self, margin: float) -> Counter:
        """Multiplicities of pairs of features, each by its vertices. Of nearly parallel edges the type is what counts."""
        found: Counter = Counter()
        collisions = self.collisions(self.positions, margin)

        def add(weight: float, *features: numpy.ndarray) -> None:
            found[feature_pair(*(self.ids[f] for f in features))] += round(weight)

        for c in collisions.vv_collisions:
            add(c.weight, [c.vertex0_id], [c.vertex1_id])
        for c in collisions.ev_collisions:
            add(c.weight, [c.vertex_id], self.edges[c.edge_id])
        for c in collisions.fv_collisions:
            add(c.weight, [c.vertex_id], self.faces[c.face_id])
        for c in collisions.ee_collisions:
            kind = c.dtype.name  # EA1_EB: the second end of the first edge, and the second edge
            ends = [edge[int(part[2]) :][:1] if len(part) > 2 else edge
                    for part, edge in zip(kind.split("_"), (self.edges[c.edge0_id], self.edges[c.edge1_id]))]
            add(c.weight, *ends)
        return found


def feature_pair(*vertices: numpy.ndarray) -> tuple[tuple[int, ...], ...]:
    """Two features by their vertices, in order."""
    return tuple(sorted((tuple(sorted(map(int, v))) for v in vertices), key=lambda v: (len(v), v)))


def features(model: limber3d.Model, margin: float, body: limber3d.Model | None = None) -> Counter:
    """limber's multiplicities of pairs of features, of a model with itself and with a body."""
    found: Counter = Counter()
    answers = [(limber3d.self_feature_pairs(model, margin), 0)]
    if body is not None:
        answers.append((limber3d.feature_pairs(model, body, margin), len(model.vertices)))
    for pairs, shift in answers:
        names = ("vertices_a", "kind_a", "vertices_b", "kind_b", "multiplicity")
        for a, kind_a, b, kind_b, multiplicity in zip(*(pairs[name].tolist() for name in names)):
            found[feature_pair(a[:kind_a + 1], [v + shift for v in b[:kind_b + 1]])] += multiplicity
    return found


def check_features(what: str, least: Counter, found: Counter, most: Counter) -> None:
    """Whether multiplicities are between those of two answers."""
    wrong = [pair for pair in least.keys() | found.keys() if not least[pair] <= found[pair] <= most[pair]]
    if wrong:
        sys.exit(f"{what}: multiplicities of {len(wrong)} differ")


def elements(model: limber3d.Model, margin: float, body: limber3d.Model | None = None) -> set:
    """limber's pairs of elements of a model with itself, and with a body whose ids follow those of the model."""
    ends, shift = model.edges.vertices, len(model.vertices)
    own = limber3d.self_element_pairs(model, margin)
    found: set = {edge_pair(ends[a], ends[b]) for a, b in zip(own.edge_edge["a"], own.edge_edge["b"])}
    found |= set(zip(own.vertex_face["vertex"].tolist(), own.vertex_face["triangle"].tolist()))
    if body is not None:
        theirs, others = body.edges.vertices.astype(int) + shift, limber3d.element_pairs(model, body, margin)
        found |= {edge_pair(ends[a], theirs[b]) for a, b in zip(others.edge_edge["a"], others.edge_edge["b"])}
        of_body = others.vertex_face["is_vertex_of_b"]
        vertices = others.vertex_face["vertex"] + numpy.where(of_body, shift, 0)
        triangles = others.vertex_face["triangle"] + numpy.where(of_body, 0, len(model.faces))
        found |= set(zip(vertices.tolist(), triangles.tolist()))
    return found


class Coal:
    """Coal and two meshes. It has no question about one mesh with itself."""

    def __init__(self, *pair: Mesh) -> None:
        self.models, self.here = [], coal.Transform3s.Identity()
        for vertices, faces in pair:
            built = coal.BVHModelOBB()
            built.beginModel(len(faces), len(vertices))
            built.addVertices(vertices)
            built.addTriangles(faces.astype(numpy.int64))
            built.endModel()
            self.models.append(built)

    def within(self, margin: float) -> coal.CollisionResult:
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        request.num_max_contacts, request.security_margin = 10_000_000, margin
        coal.collide(self.models[0], self.here, self.models[1], self.here, request, result)
        return result


class Contest:
    """Asks limber and the others, and keeps the rows of the table."""

    def __init__(self, rounds: int) -> None:
        self.rounds, self.rows = rounds, []

    def compare(self, question: str, mesh: str, ours: Call | tuple[Call, Call], count: object,
                others: dict[str, tuple[Call, object]]) -> None:
        """One question. `others` have a call and what it counts, by the name of the library."""
        times = measure.in_turn({"": ours} | {name: call for name, (call, _) in others.items()}, self.rounds)
        begin = f"| {question} | {mesh} | {1e3 * times[''][0]:.0f} | {count} |"
        for name, (_, their_count) in others.items():
            clock, processor = times[name] / times[""]
            self.rows.append(
                f"{begin} {name} | {1e3 * times[name][0]:.0f} | {their_count} | {clock:.3g} | {processor:.3g} |")
        if not others:
            self.rows.append(f"{begin} | | | | |")
        print(*self.rows[-max(1, len(others)):], sep="\n", file=sys.stderr, flush=True)

    def one_mesh(self, name: str, mesh: Mesh) -> None:
        margin, model, ipc = MARGIN * size_of(mesh), limber3d.Model(*mesh), Ipc(mesh)
        check(f"elements of {name}", elements(model, margin * (1 - 1e-9)), ipc.elements(margin),
              elements(model, margin * (1 + 1e-9)))
        check_features(f"features of {name}", features(model, margin * (1 - 1e-9)), ipc.features(margin),
                       features(model, margin * (1 + 1e-9)))
        wave = 6 * numpy.pi / size_of(mesh)
        waved = mesh[0] + 0.01 * size_of(mesh) * (1.5 + numpy.sin(wave * mesh[0][:, [1, 2, 0]]))  # every vertex moves
        broad = ipctk.LBVH()

        def move(positions: numpy.ndarray) -> None:
            model.move_all(positions)
            model.commit()

        def moved(ask: Call) -> tuple[Call, Call]:
            return lambda: move(waved), lambda: (move(mesh[0]), ask())

        def self_contacts() -> numpy.ndarray:
            return limber3d.self_contacts(model, margin)

        def self_elements() -> limber3d.ElementPairs:
            return limber3d.self_element_pairs(model, margin)

        self.compare("build", name, lambda: limber3d.Model(*mesh), len(mesh[1]), {
            "IPC Toolkit, LBVH": (lambda: broad.build(ipc.positions, ipc.edges, ipc.faces, margin / 2),
                                  len(ipc.positions) + len(ipc.edges) + len(ipc.faces))})
        meeting = len(limber3d.self_intersections(model))
        self.compare("self_intersections", name, lambda: limber3d.self_intersections(model), meeting, {})
        theirs = ipctk.has_intersections(ipc.mesh, ipc.positions, ipctk.LBVH())
        self.compare("self_collide", name, lambda: limber3d.self_collide(model), "yes" if meeting else "no", {
            "IPC Toolkit, with build": (lambda: ipctk.has_intersections(ipc.mesh, ipc.positions, ipctk.LBVH()),
                                        "yes" if theirs else "no")})
        def self_features() -> limber3d.FeaturePairs:
            return limber3d.self_feature_pairs(model, margin)

        pairs = self_elements()
        for kind, ask, count in (("self_contacts", self_contacts, len(self_contacts())),
                                 ("self_element_pairs", self_elements,
                                  f"{len(pairs.vertex_face)} + {len(pairs.edge_edge)}"),
                                 ("self_feature_pairs", self_features, len(self_features()))):
            self.compare(kind, name, ask, count, {})
            self.compare(f"move all, commit, {kind}", name, moved(ask), count, self.of_ipc(ipc, [ipc.positions], margin))

    @staticmethod
    def of_ipc(ipc: Ipc, states: list[numpy.ndarray], margin: float) -> dict[str, tuple[Call, object]]:
        """What the toolkit takes for its candidates, and for those within the margin; states take turns."""
        first, second = itertools.cycle(states), itertools.cycle(states)
        return {"IPC Toolkit, candidates alone": (lambda: ipc.candidates(next(first), margin),
                                                  len(ipc.candidates(states[0], margin))),
                "IPC Toolkit": (lambda: ipc.collisions(next(second), margin), len(ipc.collisions(states[0], margin)))}

    def two_meshes(self, name: str, a: Mesh, b: Mesh, margins: list[float]) -> None:
        one, other, peer = limber3d.Model(*a), limber3d.Model(*b), Coal(a, b)

        def ask(margin: float) -> limber3d.Contacts | limber3d.TrianglePairs:
            return limber3d.contacts(one, other, margin) if margin > 0 else limber3d.intersections(one, other)

        def pairs_within(margin: float) -> Iterable:
            found = limber3d.contacts(one, other, margin)
            return zip(found["triangle_a"].tolist(), found["triangle_b"].tolist())

        for margin in margins:
            theirs, near = [(c.b1, c.b2) for c in peer.within(margin).getContacts()], 1e-3 * margin + 1e-6
            check(f"{name} within {margin:.4g}", pairs_within(margin - near) if margin > 0 else [], theirs,
                  pairs_within(margin + near))
            question = f"contacts within {margin:.4g}" if margin > 0 else "intersections"
            self.compare(question, name, lambda m=margin: ask(m), len(ask(margin)),
                         {"Coal, OBB": (lambda m=margin: peer.within(m), len(theirs))})

    def frames(self, name: str, cloths: list[Mesh], body: Mesh) -> None:
        """One frame: all of the cloth has moved; it, with itself and with a body at rest, within the margin."""
        margin, model, other = MARGIN * size_of(cloths[0]), limber3d.Model(*cloths[0]), limber3d.Model(*body)
        ipc = Ipc(joined(cloths[0], body), len(cloths[0][0]))
        check(f"elements of {name}", elements(model, margin * (1 - 1e-9), other), ipc.elements(margin),
              elements(model, margin * (1 + 1e-9), other))
        check_features(f"features of {name}", features(model, margin * (1 - 1e-9), other), ipc.features(margin),
                       features(model, margin * (1 + 1e-9), other))
        states, state = [ipc.of(joined(c, body)[0]) for c in cloths[::-1]], itertools.cycle(cloths[::-1])

        def frame(pairs: Call, self_pairs: Call) -> object:
            model.move_all(next(state)[0])
            model.commit()
            return pairs(model, other, margin), self_pairs(model, margin)

        for kind, pairs, self_pairs in (("frame", limber3d.contacts, limber3d.self_contacts),
                                        ("frame of elements", limber3d.element_pairs, limber3d.self_element_pairs),
                                        ("frame of features", limber3d.feature_pairs, limber3d.self_feature_pairs)):
            found = frame(pairs, self_pairs)
            count = sum(len(f) for f in found) if kind != "frame of elements" else " + ".join(
                str(sum(len(getattr(f, part)) for f in found)) for part in ("vertex_face", "edge_edge"))
            self.compare(kind, name, lambda p=pairs, s=self_pairs: frame(p, s), count,
                         self.of_ipc(ipc, states, margin))


def main() -> None:
    options = measure.options_of(__doc__)
    contest = Contest(1 if options.quick else ROUNDS)
    cloth, later = (measure.read(options.meshes / f"cloth_ball_{frame}.ply") for frame in (92, 93))
    drapes = [(mesh[0][:CLOTH_VERTICES], mesh[1][:CLOTH_TRIANGLES]) for mesh in (cloth, later)]
    folded = [folded_cloth(phase) for phase in (0, 1)]
    contest.one_mesh("cloth", cloth)
    for name in ("stanford-bunny", "armadillo"):
        contest.one_mesh(name, measure.read(options.meshes / f"{name}.obj"))
    for name, cloths, body, more in (("drape", drapes, ball((0, 6.6765, 0), 5.115), [0.01]),
                                     ("folded", folded, ball((0, 0, 0), 1), [])):
        contest.two_meshes(name, cloths[0], body, [0, MARGIN * size_of(cloths[0]), *more])
        contest.frames(name, cloths, body)
    measure.write(options, "contacts.md", [
        "# Pairs of triangles and of elements, as printed by `./dev bench contacts`", "",
        "Medians in us of calls from Python, on one core. Ratios are those of the other library to limber: by the clock,",
        "and by the processor's time. [README](../../README.md) says what each library answers.", "",
        "| question | mesh | limber, us | count | library | us | count | ratio | of processor's time |",
        "|:--|:--|--:|--:|:--|--:|--:|--:|--:|", *contest.rows, "", "## Answers", "",
        "Elements are those of the IPC Toolkit, and pairs of triangles those of Coal, but for what is at the margin."])


if __name__ == "__main__":
    main()
