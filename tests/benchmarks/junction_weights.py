"""Find the weights of crossings by junction kind: `PYTHONPATH=. python tests/benchmarks/junction_weights.py`.

First counts how often a crossing of each kind is real or fake by the surveyed depth of its two lines, then solves the
line graphs of a few photos with a grid of weights. `check` compares tables on all photos. The photos of castle and
South Building are not part of the project; --data names their folder. On one core `search`, the default, takes about
five minutes, `count` half a minute, and `check`, which solves all photos, half a minute a table and reward.
"""

import argparse
import json
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from real_photos import add_data_option, surveyed_points

from linecad.arrays import Bool, Float, Int
from linecad.camera.intrinsics import undistort_points
from linecad.camera.photo import read_photo
from linecad.camera.vanishing_points import find_frame
from linecad.geometry import angle_between_frames, world_rays
from linecad.graph.build import build_line_graph
from linecad.graph.connectivity import components, spanning_tree
from linecad.graph.cues.junctions import CORNER_FACTOR, WEIGHT
from linecad.line_graph import LineGraph, ManhattanFrame, Segments
from linecad.lines.segments import find_segments, group_segments, label_segments
from linecad.model.lifting import lift
from linecad.options import SHORT_REACH, Reach
from linecad.scene import Camera
from solver.options import SolveOptions
from solver.solve import solve

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
EXTENSIONS = (30.0, 60.0)  # px at 3840 px width
REACH = 4.0  # px at 3072 px width between a segment and a surveyed point that is taken to lie on it
REACH_WIDTH = 3072.0  # px
TRUTH_STEP = 5.0  # px between the points that stand for a true line
MIN_POINTS = 2  # surveyed points that a segment needs to have a depth
AGREEING = 0.75  # share of these that must tell the segment's depth alike
SAME_DEPTH = 0.01  # relative; surveyed points of one line agree, and a crossing is real
OTHER_DEPTH = 0.03  # relative; beyond it a crossing is fake

KINDS = ("L", "T", "X")
SEARCHED = ("castle/0021", "south_building/img000062", "south_building/img000065", "samples/street", "samples/room")
BOUNDARY_REWARDS = (10.0, 1.0)  # mu_2
FACTORS = (0.5, 1.0, 2.0)  # weights of L and T that are tried; X is 1
CORNER_FACTORS = (0.25, 0.5, 1.0, 2.0)
LEAST_WEIGHT = 0.1  # of a crossing, X = 1; log-odds can be negative, weights of the paper cannot
RIDGE = 0.1  # pull of the fitted log-odds towards zero, so that a kind without a fake stays finite
FIT_STEPS = 50  # Newton steps of that fit
SEEDS = (1, 2, 3)  # of further solves with all ones: what is not larger than their spread is noise

Table = tuple[float, float, float, float]  # weights of L, T and X, and the corner factor
Counts = dict[tuple[str, bool], Int]  # (3,) real, fake and undecided crossings by kind and corner
ONES: Table = (1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Surveyed:
    """A photo's segments and what the survey knows of them."""

    name: str  # folder/photo
    camera: Camera
    frame: ManhattanFrame
    segments: Segments
    true_rotation: Float  # (3, 3) the true frame, its axes named as in `frame`
    pixels: Float  # (M, 2) px, surveyed points
    depth: Float  # (M,)
    axis: Int  # (M,) axis of the true line that a point lies on; -1 where that is not told


@dataclass(frozen=True)
class Score:
    """Crossings of one or more photos that the survey decides, and the tree's."""

    right: int = 0  # taken and real
    fake: int = 0  # taken and fake
    missed: int = 0  # real and not taken
    tree_right: int = 0
    tree_fake: int = 0

    def __add__(self, other: "Score") -> "Score":
        return Score(*(a + b for a, b in zip(self.numbers, other.numbers, strict=True)))

    @property
    def numbers(self) -> tuple[int, ...]:
        return self.right, self.fake, self.missed, self.tree_right, self.tree_fake

    @property
    def precision(self) -> float:
        return self.right / max(1, self.right + self.fake)

    @property
    def recall(self) -> float:
        return self.right / max(1, self.right + self.missed)

    @property
    def f1(self) -> float:
        return 2 * self.right / max(1, 2 * self.right + self.fake + self.missed)

    @property
    def tree_accuracy(self) -> float:
        return self.tree_right / max(1, self.tree_right + self.tree_fake)

    def __str__(self) -> str:
        return (
            f"precision {self.precision:.4f} recall {self.recall:.4f} F1 {self.f1:.4f} | "
            f"tree {self.tree_accuracy:.4f} ({self.tree_right} of {self.tree_right + self.tree_fake})"
        )


def read_surveyed(photo_file: Path, camera_file: Path, truth_file: Path) -> Surveyed:
    """Detect the segments of a photo as the pipeline does, and read its survey."""
    truth = json.loads(truth_file.read_text())
    photo = read_photo(photo_file, camera_file)
    assert photo.camera is not None
    raw = find_segments(photo.grey)
    frame = find_frame(raw, photo.camera.matrix)
    true = np.array(truth["R_cam_from_manhattan"])
    _, names = angle_between_frames(frame.rotation, true)
    renamed = np.empty((3, 3))
    renamed[:, names] = true
    points, axis = _truth_points(truth, renamed)
    return Surveyed(
        name=f"{truth_file.parent.name}/{photo_file.stem}",
        camera=photo.camera,
        frame=frame,
        segments=group_segments(label_segments(raw, photo.camera, frame), photo.camera, frame),
        true_rotation=renamed,
        pixels=undistort_points(points[:, :2], np.array(truth["K"]), (), photo.camera.matrix),
        depth=points[:, 4],
        axis=axis,
    )


def _truth_points(truth: dict[str, Any], rotation: Float) -> tuple[Float, Int]:
    """Rows u, v, X, Y, Z in the camera frame, and the axis of the line that each lies on, -1 where not told."""
    if "lines" not in truth:
        points = surveyed_points(truth)
        return points, np.full(len(points), -1)
    K = np.array(truth["K"])
    rows, axes = [], []
    for line in truth["lines"]:
        ends = np.array([line["P_cam"], line["Q_cam"]])
        if line["label"] < 0:
            continue
        count = max(2, int(np.linalg.norm(np.subtract(line["q"], line["p"])) / TRUTH_STEP))
        at = np.linspace(0, 1, count)
        # Evenly spaced in the image: the share of the far end grows with its nearness.
        share = at * ends[0, 2] / (at * ends[0, 2] + (1 - at) * ends[1, 2])
        space = ends[0] + share[:, None] * (ends[1] - ends[0])
        image = space @ K.T
        rows.append(np.column_stack([image[:, :2] / image[:, 2:], space]))
        axes.append(np.full(count, np.abs((ends[1] - ends[0]) @ rotation).argmax()))
    return np.concatenate(rows), np.concatenate(axes)


def middle_depths(graph: LineGraph, photo: Surveyed) -> Float:
    """Camera depth (N,) of each segment's middle by the surveyed points on it, NaN where they are few or disagree."""
    rays = world_rays(photo.pixels, photo.camera.matrix, photo.true_rotation)
    middle = world_rays(graph.segments.ends.mean(axis=1), photo.camera.matrix, photo.true_rotation)
    found = np.full(len(graph.segments), np.nan)
    reach = REACH * photo.camera.width / REACH_WIDTH
    for k, (start, end) in enumerate(graph.segments.ends):
        length = float(np.linalg.norm(end - start))
        along = (end - start) / length
        position = (photo.pixels - start) @ along
        distance = np.abs((photo.pixels - start) @ np.array([-along[1], along[0]]))
        near = (position >= 0) & (position <= length) & (distance <= reach)
        near &= (photo.axis < 0) | (photo.axis == graph.axis[k])
        if near.sum() < MIN_POINTS:
            continue
        told = _depth_along(rays[near] * photo.depth[near, None], middle[k], int(graph.axis[k]))
        depth = float(np.median(told))
        if np.mean(np.abs(told / depth - 1) <= SAME_DEPTH) >= AGREEING:
            found[k] = depth
    return found


def _depth_along(points: Float, rays: Float, axis: int) -> Float:
    """Camera depth where lines of direction `axis` through world points (..., 3) pass rays (..., 3) of depth 1."""
    across = np.delete(np.arange(3), axis)
    depth: Float = (points[..., across] * rays[..., across]).sum(axis=-1) / (rays[..., across] ** 2).sum(axis=-1)
    return depth


def judge(graph: LineGraph, photo: Surveyed) -> tuple[Bool, Bool, Bool]:
    """Masks (E,) of the crossings that are real, fake, and neither though both depths are known."""
    depth = middle_depths(graph, photo)
    middle = world_rays(graph.segments.ends.mean(axis=1), photo.camera.matrix, photo.true_rotation)
    crossing = world_rays(graph.crossing, photo.camera.matrix, photo.true_rotation)
    at_crossing = np.array(
        [
            [_depth_along(depth[k] * middle[k], ray, int(graph.axis[k])) for k in pair]
            for pair, ray in zip(graph.edges.tolist(), crossing, strict=True)
        ]
    ).reshape(-1, 2)
    difference = np.abs(at_crossing[:, 0] / at_crossing[:, 1] - 1)
    known = np.isfinite(difference)
    real, fake = known & (difference <= SAME_DEPTH), known & (difference > OTHER_DEPTH)
    return real, fake, known & ~real & ~fake


def count_kinds(photos: Iterable[Surveyed], extension: float) -> Counts:
    """Real, fake and undecided crossings (3,) by kind and corner."""
    counts = {key: np.zeros(3, np.int64) for key in product(KINDS, (False, True))}
    for photo in photos:
        graph = build_line_graph(photo.segments, photo.camera, photo.frame, _reach(extension), "ones")
        judged = judge(graph, photo)
        for (kind, corner), count in counts.items():
            members = (graph.kind == kind) & (graph.corner == corner) & graph.possible
            count += [int((members & mask).sum()) for mask in judged]
    return counts


def _reach(extension: float) -> Reach:
    return replace(SHORT_REACH, extension=extension)


def log_odds(count: Int) -> float:
    """Natural log of real over fake crossings, half a crossing added to both so that none is infinite."""
    return float(np.log((count[0] + 0.5) / (count[1] + 0.5)))


def pooled_table(total: Counts) -> Table:
    """Weights in proportion to the log-odds of each kind in all photos together; the corner factor from all kinds."""
    by_kind = [log_odds(total[kind, False] + total[kind, True]) for kind in KINDS]
    by_corner = [log_odds(np.sum([total[kind, corner] for kind in KINDS], axis=0)) for corner in (False, True)]
    return _table(by_kind, by_corner[1] / by_corner[0])


def stratified_table(folders: list[Counts]) -> Table:
    """Weights by a logistic fit of real against fake on folder, kind and corner.

    Folders differ more than kinds do, and corners and X junctions are not spread evenly over them; counted together,
    a kind would be judged by the folder that has most of it. Each folder counts alike in the means.
    """
    rows, counts = [], []
    for number, folder in enumerate(folders):
        for (kind, corner), count in folder.items():
            rows.append(np.r_[np.arange(len(folders)) == number, np.array(KINDS) == kind, corner].astype(float))
            counts.append(count[:2])
    features, (real, fake) = np.array(rows), np.array(counts, float).T
    effect = np.zeros(features.shape[1])
    for _ in range(FIT_STEPS):
        share = 1 / (1 + np.exp(-features @ effect))
        slope = features.T @ (real - (real + fake) * share) - RIDGE * effect
        bend = (features.T * ((real + fake) * share * (1 - share))) @ features + RIDGE * np.eye(len(effect))
        effect += np.linalg.solve(bend, slope)
    by_kind = float(effect[: len(folders)].mean()) + effect[len(folders) : -1]
    mean = float(by_kind.mean())
    return _table(by_kind.tolist(), (mean + float(effect[-1])) / mean)


def _table(by_kind: list[float], corner: float) -> Table:
    left, tee, cross = (max(LEAST_WEIGHT, odds / by_kind[2]) for odds in by_kind)
    return left, tee, cross, max(LEAST_WEIGHT, corner)


def print_counts(photos: list[Surveyed]) -> dict[str, Table]:
    """Print how often each kind is real, by folder and reach; tables of log-odds by name."""
    names = sorted({photo.name.split("/")[0] for photo in photos})
    tables = {}
    for extension in EXTENSIONS:
        folders = [count_kinds((photo for photo in photos if photo.name.startswith(name)), extension) for name in names]
        total = {key: np.sum([counts[key] for counts in folders], axis=0) for key in folders[0]}
        for name, counts in zip([*names, "all"], [*folders, total], strict=True):
            _print_count(f"{name} {extension:.0f} px", counts)
        tables[f"log-odds pooled {extension:.0f} px"] = pooled_table(total)
        tables[f"log-odds by folder {extension:.0f} px"] = stratified_table(folders)
    for name, table in tables.items():
        print(f"{name}: {_words(table)}", flush=True)
    return tables


def _print_count(title: str, counts: Counts) -> None:
    print(title)
    for (kind, corner), count in counts.items():
        fake = count[1] / max(1, count[0] + count[1])
        print(
            f"  {kind} {'corner' if corner else '      '} real {count[0]:6d} fake {count[1]:5d} undecided {count[2]:5d}"
            f" fake share {fake:6.2%} log-odds {log_odds(count):5.2f}",
            flush=True,
        )


def _words(table: Table) -> str:
    return f"L {table[0]:.2f} T {table[1]:.2f} X {table[2]:.2f} corner {table[3]:.2f}"


@dataclass(frozen=True, eq=False)
class Judged:
    """The largest component of a photo's line graph, with the truth of its crossings."""

    name: str
    graph: LineGraph
    real: Bool  # (E,)
    fake: Bool  # (E,)

    def score(self, table: Table, options: SolveOptions) -> Score:
        """Solve with the weights of `table`; count the crossings that the survey decides."""
        graph = replace(self.graph, weight=_weights(self.graph, table))
        solution = solve(graph, options)
        telling = solution.connected & graph.informative
        largest = np.zeros(len(graph.segments), bool)
        largest[components(graph, telling)[0]] = True
        in_largest = telling & largest[graph.edges].all(axis=1)
        tree = spanning_tree(graph, in_largest, lift(graph, solution.connected, solution.log_depth).residual)
        taken = solution.connected
        masks = (taken & self.real, taken & self.fake, ~taken & self.real, tree & self.real, tree & self.fake)
        return Score(*(int(mask.sum()) for mask in masks))


def judged(photo: Surveyed, extension: float) -> Judged:
    """The part of a photo that the pipeline solves with --largest-component."""
    whole = build_line_graph(photo.segments, photo.camera, photo.frame, _reach(extension), "ones")
    graph = whole.subset(components(whole)[0])
    real, fake, _ = judge(graph, photo)
    return Judged(photo.name, graph, real, fake)


def _weights(graph: LineGraph, table: Table) -> Float:
    by_kind = dict(zip(KINDS, table, strict=False))
    weights: Float = np.array([by_kind[kind] for kind in graph.kind.tolist()]) * np.where(graph.corner, table[3], 1.0)
    return weights


def search(photos: list[Judged], candidates: dict[str, Table], seconds: float) -> None:
    """Print the score of every table of the grid and of the candidates, and the noise of the seeds, for each mu_2."""
    grid = [(left, tee, 1.0, corner) for left, tee, corner in product(FACTORS, FACTORS, CORNER_FACTORS)]
    for reward in BOUNDARY_REWARDS:
        options = SolveOptions(mu_boundary=reward, time_limit_s=seconds)
        rows = [("grid", table, _total(photos, table, options)) for table in grid]
        rows += [(name, table, _total(photos, table, options)) for name, table in candidates.items()]
        rows += [(f"seed {seed}", ONES, _total(photos, ONES, replace(options, seed=seed))) for seed in SEEDS]
        print(f"mu_2 = {reward:g}, {len(photos)} photos, best first")
        for name, table, score in sorted(rows, key=lambda row: -row[2].f1):
            print(f"  {_words(table)} | {score} | {name}", flush=True)


def _total(photos: list[Judged], table: Table, options: SolveOptions) -> Score:
    return sum((photo.score(table, options) for photo in photos), Score())


def check(photos: list[Judged], candidates: dict[str, Table], seconds: float) -> None:
    """Print the score of each candidate for each mu_2: a line a folder, and one for the photos of the search or not."""
    for reward in BOUNDARY_REWARDS:
        options = SolveOptions(mu_boundary=reward, time_limit_s=seconds)
        for name, table in candidates.items():
            scores = {photo.name: photo.score(table, options) for photo in photos}
            print(f"mu_2 = {reward:g}, {name}: {_words(table)}")
            for folder in sorted({photo.split("/")[0] for photo in scores}):
                _print_part(folder, [score for photo, score in scores.items() if photo.startswith(folder)])
            _print_part("searched", [score for photo, score in scores.items() if photo in SEARCHED])
            _print_part("held out", [score for photo, score in scores.items() if photo not in SEARCHED])
            _print_part("all", list(scores.values()))


def _print_part(title: str, scores: list[Score]) -> None:
    print(f"  {title:15} {sum(scores, Score())}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("part", choices=["count", "search", "check"], nargs="?", default="search")
    add_data_option(parser)
    parser.add_argument("--extension", type=float, default=30.0, help="of the graphs that are solved")
    parser.add_argument("--time-limit", type=float, default=5.0, help="s a photo")
    parser.add_argument(
        "--table", type=float, nargs=4, action="append", default=[], metavar=("L", "T", "X", "CORNER"),
        help="a table to check beside linecad's and all ones",
    )  # fmt: skip
    chosen = parser.parse_args()
    began = time.perf_counter()
    photos = [
        read_surveyed(truth.with_suffix(".jpg"), truth, truth)
        for folder in ("castle", "south_building")
        for truth in sorted((chosen.data / folder).glob("*.json"))
    ]
    for truth in sorted(SAMPLES.glob("*.truth.json")):
        name = truth.name.removesuffix(".truth.json")
        photos.append(read_surveyed(SAMPLES / f"{name}.jpg", SAMPLES / f"{name}.json", truth))
    candidates = print_counts(photos)
    if chosen.part == "search":
        solved = [judged(photo, chosen.extension) for photo in photos if photo.name in SEARCHED]
        search(solved, candidates, chosen.time_limit)
    if chosen.part == "check":
        candidates = {"all ones": ONES, "linecad": (WEIGHT["L"], WEIGHT["T"], WEIGHT["X"], CORNER_FACTOR)}
        candidates |= {f"given {place}": (L, T, X, corner) for place, (L, T, X, corner) in enumerate(chosen.table, 1)}
        check([judged(photo, chosen.extension) for photo in photos], candidates, chosen.time_limit)
    print(f"{time.perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
