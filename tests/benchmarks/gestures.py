"""What gestures about bodies are worth: python tests/benchmarks/gestures.py DATASET [--only 0015] [--gestures 6]

For photos of known depth: the automatic model, and then one gesture of the page of `linecad edit` after the other, by
somebody who sees which body stands wrong. Each takes the body with the most known points that are off, and puts it at
one of its other places where one of those that the page proposes is right (*next place*), else drags it there, by a
hand that is off by HAND (*move*). A body on which few points tell, or that is wrong inside, stays. Prints recall and
precision at 5 % of everything in the file before and after each gesture.
"""

import argparse
from pathlib import Path

import numpy as np

from linecad.arrays import Float
from linecad.corrections.edits import Corrections, PlaceAt
from linecad.editing.bodies import ShownBodies
from linecad.editing.session import Session
from linecad.editing.solving import TaskSolver
from linecad.evaluation.datasets import find_dataset
from linecad.evaluation.depth import score_depth
from linecad.evaluation.references import Points, open_case
from linecad.geometry import distances_to
from linecad.lines.segments import find_segments
from linecad.options import Options
from linecad.ties.alternatives import other_places
from linecad.ties.facts import depth_at

NEAR = 3.0  # px between a known point and the segment that it is of
RIGHT = 0.05  # log depth
SEEN = 0.03  # log factor by which a proposed place may miss the truth to be taken for it
HAND = 0.02  # log factor, standard deviation, by which a body that is dragged misses its place
LEAST_POINTS = 15  # that tell of a body


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--only", default="", help="photos whose name starts so")
    parser.add_argument("--gestures", type=int, default=6)
    chosen = parser.parse_args()
    for case in find_dataset(chosen.dataset).cases:
        if not case.name.startswith(chosen.only):
            continue
        photo, reference = open_case(case)
        if reference.edges is None:
            continue
        corrections = Corrections(photo.name, photo.width, photo.height)
        session = Session(photo, find_segments(photo.grey), Options(), corrections, lambda _: None)
        told = steps(session, TaskSolver(photo, Options()), reference.edges, chosen.gestures)
        print(f"{case.name}: {' -> '.join(told)}", flush=True)


def steps(session: Session, solver: TaskSolver, points: Points, most: int) -> list[str]:
    """What is right before and after each gesture."""
    random, told = np.random.default_rng(0), [scored(session, solver, points)]
    moved: set[int] = set()
    while len(told) <= most:
        gesture = next_gesture(session, points, moved, random)
        if gesture is None:
            break
        word, fact = gesture
        put(session, fact)
        told.append(f"{word} {scored(session, solver, points)}")
    return told


def put(session: Session, fact: PlaceAt) -> None:
    session.edit(session.now().version, lambda _: fact)


def scored(session: Session, solver: TaskSolver, points: Points) -> str:
    session.take(solver.answer(session.task(session.now().version), lambda _: None))
    now = session.now()
    assert now.model is not None, now.error
    score = score_depth(now.model.scene, points.pixels, points.depth)
    return f"{score.recall_5:.3f} / {score.precision_5:.3f}"


def next_gesture(
    session: Session, points: Points, moved: set[int], random: np.random.Generator
) -> tuple[str, PlaceAt] | None:
    """The gesture that puts most known points right; `moved` are lines of bodies that were put somewhere before."""
    model = session.now().model
    assert model is not None
    assert model.bodies is not None
    bodies = model.bodies
    evidence = bodies.now.evidence
    off, count = errors(bodies, points)
    for body in np.argsort(-np.where(np.abs(off) > RIGHT, count, 0), kind="stable").tolist():
        line = max(evidence.setting.lines[body].tolist(), key=lambda own: length(bodies, own))
        if count[body] < LEAST_POINTS or abs(off[body]) <= RIGHT:
            return None
        if bodies.ids[line] in moved or body == evidence.reference:
            continue
        moved.add(bodies.ids[line])
        places = [place.move for place in other_places(bodies.now, body)]
        best = min(places, key=lambda move: abs(move - off[body]), default=np.inf)
        word, move = (
            ("next place", best) if abs(best - off[body]) < SEEN else ("move", off[body] + random.normal(0, HAND))
        )
        return word, placed(session, bodies, line, move)
    return None


def errors(bodies: ShownBodies, points: Points) -> tuple[Float, Float]:
    """(B,) by which log factor bodies must move to stand right to the reference, and how many points say so."""
    setting = bodies.now.evidence.setting
    near = distances_to(points.pixels, setting.graph.segments.ends)
    which = near.argmin(axis=1)
    body = np.where(near.min(axis=1) < NEAR, setting.bodies.body[which], -1)
    ratio = np.full(len(which), np.nan)
    for point in np.flatnonzero(body >= 0).tolist():
        depth = depth_at(setting, int(which[point]), points.pixels[point])
        ratio[point] = np.log(points.depth[point] / depth) - bodies.now.log_scale[body[point]]
    found, count = np.zeros(bodies.count), np.bincount(body[body >= 0], minlength=bodies.count).astype(float)
    for own in range(bodies.count):
        found[own] = np.median(ratio[body == own]) if count[own] else 0.0
    return found - found[bodies.now.evidence.reference], count


def placed(session: Session, bodies: ShownBodies, line: int, move: float) -> PlaceAt:
    """The fact that a body, by one of its lines, stands so much farther than it does."""
    setting = bodies.now.evidence.setting
    to = max(setting.lines[bodies.now.evidence.reference].tolist(), key=lambda own: length(bodies, own))
    depths = [depth_at(setting, own, setting.graph.segments.ends[own].mean(axis=0)) * np.exp(
        bodies.now.log_scale[setting.bodies.body[own]]) for own in (line, to)]  # fmt: skip
    one, other = (session.editing.anchor(bodies.ids[own]) for own in (line, to))
    return PlaceAt(one, other, float(np.log(depths[0] / depths[1]) + move))


def length(bodies: ShownBodies, line: int) -> float:
    return float(bodies.now.evidence.setting.graph.segments.length[line])


if __name__ == "__main__":
    main()
