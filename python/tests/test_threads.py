# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause
"""Several threads: queries side by side, changes refused, the GIL released."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import limber3d
import numpy
import pytest
import shapes

POSES = shapes.random_poses(1, 200, 1.5)


def test_changes_under_queries_are_refused_and_never_crash() -> None:
    vertices, faces = shapes.ball(60, 40)
    model = limber3d.Model(vertices, faces)
    scene = limber3d.Scene()
    scene.add(model)
    surface = limber3d.ClosedSurface(model)
    stop = threading.Event()
    counts = {"changed": 0, "not changed": 0, "answered": 0, "not answered": 0, "stale": 0}
    unexpected: list[BaseException] = []

    def attempt(call: object, success: str) -> None:
        try:
            call()  # type: ignore[operator]
            counts[success] += 1
        except limber3d.BusyError:
            counts[f"not {success}"] += 1
        except ValueError as error:
            if not any(word in str(error) for word in ("commit", "reset", "positions")):
                raise
            counts["stale"] += 1

    def keep_on(calls: list[object], success: str) -> None:
        try:
            while not stop.is_set():
                for call in calls:
                    attempt(call, success)
                    time.sleep(1e-4)
        except BaseException as error:
            unexpected.append(error)

    changes: list[object] = [
        lambda: model.move_all(vertices * 1.01),
        model.commit,
        lambda: model.reset(vertices, faces),
        lambda: model.reset(*shapes.ball(10, 8)),
        lambda: model.reset(vertices, faces),
    ]
    questions: list[object] = [
        lambda: limber3d.distance(model, model, POSES[0]),
        lambda: limber3d.self_collide(model),
        lambda: limber3d.self_element_pairs(model, 0.01),
        lambda: surface.contains([0, 0, 0]),
        lambda: limber3d.closest_point_many(model, vertices),
        scene.commit,
        lambda: scene.closest_objects(),
        lambda: model.vertices,
    ]
    threads = [threading.Thread(target=keep_on, args=(changes, "changed"))]
    threads += [threading.Thread(target=keep_on, args=(questions, "answered")) for _ in range(2)]
    for thread in threads:
        thread.start()
    time.sleep(1.5)
    stop.set()
    for thread in threads:
        thread.join()
    assert not unexpected
    assert min(counts[count] for count in ("changed", "answered", "stale")) > 0, counts


def test_the_gil_is_released() -> None:
    """While a call runs, another thread of Python goes on: it gets the GIL only where the caller lets go of it."""
    vertices, faces = shapes.ball(200, 200)
    model, other, moved = (limber3d.Model(vertices, faces) for _ in range(3))
    surface = limber3d.ClosedSurface(model)
    scene = limber3d.Scene()
    pairs = [[scene.add(model), scene.add(other)]] * 100
    scene.commit()
    stop, ticks = threading.Event(), 0

    def tick() -> None:
        nonlocal ticks
        while not stop.is_set():
            time.sleep(1e-4)
            ticks += 1

    calls: dict[str, Callable[[], object]] = {
        "Model": lambda: limber3d.Model(vertices, faces),
        "move_all": lambda: moved.move_all(vertices),
        "rebuild": moved.rebuild,
        "validate": model.validate,
        "distance": lambda: limber3d.distance(model, other, POSES[0]),
        "collide": lambda: limber3d.collide(model, other, POSES[0]),
        "contacts": lambda: limber3d.contacts(model, other, 0.01, POSES[0]),
        "self_collide": lambda: limber3d.self_collide(model),
        "self_element_pairs": lambda: limber3d.self_element_pairs(model, 1e-3),
        "NeighborRings": lambda: limber3d.NeighborRings(model, 1),
        "closest_point_many": lambda: limber3d.closest_point_many(model, vertices),
        "contains_many": lambda: surface.contains_many(vertices),
        "scene.distance": lambda: scene.distance(pairs),
        "distance_many": lambda: limber3d.distance_many(model, other, POSES),
        "time_of_impact_many": lambda: limber3d.time_of_impact_many(model, other, POSES[1:], POSES[:-1]),
        "closest_objects_many": lambda: limber3d.closest_objects_many(scene, [0], POSES[:, None]),
    }
    thread = threading.Thread(target=tick)
    interval = sys.getswitchinterval()
    try:
        thread.start()
        sys.setswitchinterval(100)
        for name, call in calls.items():
            before, end = ticks, time.monotonic() + 5
            while ticks == before and time.monotonic() < end:
                call()
            assert ticks > before, name
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        thread.join()


def test_a_cache_serves_one_query_at_a_time(ball: limber3d.Model) -> None:
    cache = limber3d.QueryCache()
    refused = 0

    def using_it_again(a: int, b: int) -> bool:
        nonlocal refused
        try:
            limber3d.distance(ball, ball, cache=cache)
        except limber3d.BusyError:
            refused += 1
        return True

    limber3d.self_distance(ball, filter=using_it_again, cache=cache)
    assert refused > 0
    assert limber3d.distance(ball, ball, cache=cache).upper == 0


@pytest.fixture(scope="module")
def long_calls() -> dict[str, Callable[[], object]]:
    """Calls of each kind that take seconds."""
    corners = numpy.random.default_rng(3).normal(size=(2, 120_000, 3))
    soup, other = (limber3d.Model(c, numpy.arange(120_000).reshape(-1, 3)) for c in corners)
    ball = limber3d.Model(*shapes.ball(150, 100))
    surface, huge = limber3d.ClosedSurface(ball), shapes.ball(1000, 1000)
    small = limber3d.ClosedSurface(limber3d.Model(*shapes.ball(40, 30)))
    scene = limber3d.Scene()
    pairs = numpy.tile([scene.add(ball), scene.add(ball, ([1, 0, 0, 0], [2.001, 0, 0]))], (1_000_000, 1))
    scene.commit()
    points = numpy.random.default_rng(4).normal(size=(2_000_000, 3)) * 0.01
    ball_points = points[:8000] / numpy.linalg.norm(points[:8000], axis=1)[:, None]
    meeting, crowd = limber3d.Scene(), limber3d.Scene()
    meeting.add(soup), meeting.add(other)
    meeting.commit()
    for _ in range(20_000):
        crowd.add(ball)
    crowd.commit()
    touching = limber3d.contacts(soup, other, 0.0, max_count=60_000).records
    falls, stays = limber3d.MovingModel(soup), limber3d.MovingModel(other)
    falls.set_motion(soup.vertices + 1)
    stays.set_motion(other.vertices)
    return {
        "Model": lambda: [limber3d.Model(*huge) for _ in range(9)],
        "convex_hull": lambda: [limber3d.Shape.convex_hull(ball_points) for _ in range(99)],
        "candidate_pairs": lambda: crowd.candidate_pairs(9),
        "reduce_contacts": lambda: [limber3d.reduce_contacts(touching, 0.001) for _ in range(99)],
        "Scene.contacts of two": lambda: meeting.contacts([[0, 1]] * 9, 1.0),
        "intersections": lambda: limber3d.intersections(soup, other),
        "self_intersections": lambda: limber3d.self_intersections(soup, parallel=True),
        "impacts": lambda: limber3d.impacts(falls, stays, parallel=True),
        "solid_relation": lambda: [limber3d.solid_relation(surface, surface) for _ in range(99)],
        "closest_point_many": lambda: limber3d.closest_point_many(ball, points),
        "contains_many": lambda: surface.contains_many(points),
        "signed_distance_many": lambda: surface.signed_distance_many(points),
        "solid_relation_many": lambda: limber3d.solid_relation_many([small, small], [[0, 1]] * 9999),
        "Scene.distance": lambda: scene.distance(pairs),
        "Scene.contacts": lambda: scene.contacts(pairs, 0.01),
    }


MANY = ("_many", "Scene.")


@pytest.mark.parametrize("name", ["Model", "intersections", "self_intersections", "impacts", "solid_relation",
                                  "closest_point_many", "contains_many", "signed_distance_many", "solid_relation_many",
                                  "Scene.distance", "Scene.contacts", "Scene.contacts of two", "candidate_pairs",
                                  "convex_hull", "reduce_contacts"])  # fmt: skip
def test_control_c_ends_long_calls_and_keeps_what_is_done(long_calls: dict[str, Any], name: str) -> None:
    before, sent = signal.signal(signal.SIGINT, signal.default_int_handler), 0.0

    def send() -> None:
        nonlocal sent
        sent = time.monotonic()
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    timer = threading.Timer(0.5, send)
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt) as interrupted:
            long_calls[name]()
        elapsed = time.monotonic() - sent
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)
    assert elapsed < 2  # 0.3 on a machine that does nothing else
    if any(part in name for part in MANY):
        assert isinstance(interrupted.value, limber3d.BatchInterrupted)
        assert len(interrupted.value.results) == interrupted.value.count
        assert interrupted.value.count > 0 or name == "Scene.contacts of two"


@pytest.fixture(scope="module")
def copying_calls() -> dict[str, Callable[[], object]]:
    """Calls that do little but copy arguments or answers, or change a large model."""
    points, corners = numpy.zeros((1_000_000, 3)), numpy.arange(1_500_000).reshape(-1, 3)
    poses = numpy.tile(numpy.eye(4), (300_000, 1, 1))
    corners[-1], poses[-1] = -1, numpy.nan  # errors, unless Ctrl-C comes before
    tall, ball = limber3d.Model(points, [[0, 1, 2]]), limber3d.Model(*shapes.ball())
    moving, matrix = limber3d.MovingModel(tall), limber3d.ObjectPairMatrix(6000)
    dtype = limber3d.contact_dtype
    records = numpy.zeros(100_000, [(name, dtype[name]) for name in dtype.names or ()])  # laid out as others do
    return {
        "weld": lambda: limber3d.weld(points, corners),
        "columns": lambda: limber3d.weld(points[::-1, ::-1], corners),
        "vertices": lambda: tall.vertices,
        "collide_many": lambda: limber3d.collide_many(ball, ball, poses),
        "reduce_contacts": lambda: limber3d.reduce_contacts(records, -1.0),
        "move_all": lambda: tall.move_all(points[::-1]),
        "set_motion": lambda: moving.set_motion(points),
        "set_among": lambda: matrix.set_among(numpy.arange(6000), False),
    }


@pytest.mark.parametrize(
    "name", "weld columns vertices collide_many reduce_contacts move_all set_motion set_among".split()
)
def test_control_c_is_heard_while_arrays_are_copied(copying_calls: dict[str, Any], name: str) -> None:
    waits = {0.0002, 0.0003, 0.0004}  # one is taken each time that handlers may run; then there is a KeyError
    before = signal.signal(signal.SIGALRM, lambda *_: signal.setitimer(signal.ITIMER_REAL, waits.pop()))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.0001)
        with pytest.raises(KeyError):
            copying_calls[name]()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_a_call_goes_on_where_the_handler_raises_nothing() -> None:
    corners = numpy.random.default_rng(3).normal(size=(30_000, 3))
    soup, seen = limber3d.Model(corners, numpy.arange(30_000).reshape(-1, 3)), []
    expected = limber3d.self_intersections(soup).records

    def ignore_the_next(*_: object) -> None:
        seen.append(signal.signal(signal.SIGINT, signal.SIG_IGN))

    before = signal.signal(signal.SIGINT, ignore_the_next)
    timer = threading.Timer(0.1, lambda: signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT))
    try:
        timer.start()
        found = limber3d.self_intersections(soup)
        timer.join()
        signal.raise_signal(signal.SIGINT)  # what the handler has set holds
    finally:
        signal.signal(signal.SIGINT, before)
    assert seen and found.is_complete and (found.records == expected).all()


def test_who_changes_a_model_gets_it_beside_busy_readers() -> None:
    vertices, faces = shapes.ball(60, 40)
    model, stop = limber3d.Model(vertices, faces), threading.Event()

    def ask() -> None:
        while not stop.is_set():
            limber3d.closest_point_many(model, vertices)

    with ThreadPoolExecutor(2) as pool:
        readers = [pool.submit(ask) for _ in range(2)]
        try:
            for _ in range(100):
                model.rebuild()
        finally:
            stop.set()
        assert all(reader.result() is None for reader in readers)


DAEMONS = """
import sys, threading, time
sys.path.append(sys.argv[1])
import limber3d, shapes
ball, large = limber3d.Model(*shapes.ball()), limber3d.Model(*shapes.ball(200, 200))
def ask(model):
    while True:
        limber3d.distance(model, model, ([1, 0, 0, 0], [3, 0, 0]))
def search():
    while True:
        limber3d.self_contacts(large, 0.02)
for target, arguments in ((ask, [ball]), (ask, [large]), (search, [])):
    threading.Thread(target=target, args=arguments, daemon=True).start()
time.sleep(0.05)
"""


def test_python_may_end_while_daemons_ask() -> None:
    for _ in range(4):
        command = [sys.executable, "-c", DAEMONS, str(Path(__file__).parent)]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert (ended.returncode, ended.stderr) == (0, "")
