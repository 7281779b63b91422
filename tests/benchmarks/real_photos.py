"""Measure on real photos with ground truth: `python tests/benchmarks/real_photos.py castle|york_urban|south_building`.

The photos are not part of the project; --data names their folder. Prints one line a photo and one for all.
"""

import argparse
import json
import os
import time
from pathlib import Path
from typing import Any

import numpy as np

from linecad.arrays import Float
from linecad.camera.intrinsics import undistort_points
from linecad.camera.photo import read_photo
from linecad.camera.vanishing_points import find_frame
from linecad.evaluation.depth import score_depth
from linecad.evaluation.frames import nearest_axes
from linecad.finding import find_lines
from linecad.geometry import angle_between_frames
from linecad.lines.segments import find_segments
from linecad.options import Options
from linecad.pipeline import reconstruct_lines
from solver.options import SolveOptions


def measure_depth(truth_file: Path, options: Options) -> tuple[float, ...]:
    truth = json.loads(truth_file.read_text())
    photo = read_photo(truth_file.with_suffix(".jpg"), truth_file)
    made = reconstruct_lines(photo.name, find_lines(photo, faint=options.faint), options)
    scene = made.scene
    points = surveyed_points(truth)
    pixels = undistort_points(points[:, :2], np.array(truth["K"]), (), scene.camera.matrix)
    score = score_depth(scene, pixels, points[:, 4])
    error, _ = angle_between_frames(scene.rotation, np.array(truth["R_cam_from_manhattan"]))
    real = scene.intersections.real
    figures = (
        len(scene.lines), len(real), real.mean(), len(scene.planes), score.recall_2, score.recall_5, score.precision_2,
        score.precision_5, np.degrees(error), made.solution.seconds, scene.solve.gap,
    )  # fmt: skip
    print(
        f"{truth_file.stem:10} {figures[0]:5d} lines {figures[1]:5d} crossings {figures[2]:5.1%} real "
        f"{figures[3]:3d} planes | "
        f"recall 2 % {figures[4]:.2f} 5 % {figures[5]:.2f} precision 2 % {figures[6]:.2f} 5 % {figures[7]:.3f} | "
        f"rotation {figures[8]:.2f} deg | {scene.solve.status} {figures[9]:.1f} s gap {figures[10]:.2%}",
        flush=True,
    )
    return tuple(float(figure) for figure in figures)


def surveyed_points(truth: dict[str, Any]) -> Float:
    """Rows u, v, X, Y, Z of points on Manhattan segments: surveyed, or sampled on reconstructed lines."""
    if "points" in truth:
        return np.array(truth["points"], float)[truth["on_line"], :5]
    rows = []
    K = np.array(truth["K"])
    for line in truth["lines"]:
        if line["label"] < 0:
            continue
        ends = np.array([line["P_cam"], line["Q_cam"]])
        count = max(2, int(np.linalg.norm(np.subtract(line["q"], line["p"])) / 40))
        at = np.linspace(0.1, 0.9, count)
        # Evenly spaced in the image: the share of the far end grows with its nearness.
        share = at * ends[0, 2] / (at * ends[0, 2] + (1 - at) * ends[1, 2])
        space = ends[0] + share[:, None] * (ends[1] - ends[0])
        image = space @ K.T
        rows.append(np.column_stack([image[:, :2] / image[:, 2:], space]))
    return np.concatenate(rows)


def measure_frame(truth_file: Path) -> tuple[float, float, float]:
    truth = json.loads(truth_file.read_text())
    K, true = np.array(truth["K"]), np.array(truth["vp_dirs_orthogonal"])
    photo = read_photo(truth_file.with_suffix(".jpg"), truth_file)
    segments = find_segments(photo.grey)
    started = time.perf_counter()
    frame = find_frame(segments, K)
    seconds = time.perf_counter() - started
    error, _ = angle_between_frames(frame.rotation, np.array(truth["R_cam_from_manhattan"]))
    ends = np.array([[line["p"], line["q"]] for line in truth["lines"]])
    label_of_axis = np.abs(true @ frame.rotation).argmax(axis=0) + 1
    right = label_of_axis[nearest_axes(ends, K, frame.rotation)] == [line["label"] for line in truth["lines"]]
    return float(np.degrees(error)), float(np.mean(right)), seconds


def add_data_option(parser: argparse.ArgumentParser) -> None:
    """Let the user name the folder with the photographs for measuring; LINECAD_DATA does so for every run."""
    usual = os.environ.get("LINECAD_DATA")
    phrase = "the folder with castle, york_urban and south_building; LINECAD_DATA, where that is set"
    parser.add_argument("--data", type=Path, default=usual, required=not usual, help=phrase)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", choices=["castle", "york_urban", "south_building"])
    add_data_option(parser)
    parser.add_argument("--extension", type=float, default=30.0)
    parser.add_argument("--weights", default="junctions")
    parser.add_argument("--formulation", default="gain")
    parser.add_argument("--collinear", action=argparse.BooleanOptionalAction, default=None)
    parser.add_argument("--mu-planarity", type=float, default=SolveOptions.mu_planarity)
    parser.add_argument("--mu-boundary", type=float, default=None)
    parser.add_argument("--without", default="")
    parser.add_argument("--time-limit", type=float, default=60.0)
    chosen = parser.parse_args()
    files = sorted((chosen.data / chosen.dataset).glob("*.json"))
    if not files:
        parser.error(f"there are no photos in {chosen.data / chosen.dataset}; name their folder with --data")
    if chosen.dataset == "york_urban":
        errors, labels, seconds = np.array([measure_frame(file) for file in files]).T
        print(
            f"{len(files)} photos: rotation error median {np.median(errors):.2f} deg, mean {errors.mean():.2f}, "
            f"below 2 deg {np.mean(errors < 2):.1%}, worst {errors.max():.1f}; "
            f"labels of marked lines right {labels.mean():.2%}; "
            f"{np.median(seconds) * 1e3:.0f} ms a photo after detection"
        )
        return
    options = Options(
        extension=chosen.extension,
        weights=chosen.weights,
        collinear=chosen.collinear,
        largest_component=True,
        solve=SolveOptions(
            formulation=chosen.formulation,
            mu_planarity=chosen.mu_planarity,
            mu_boundary=chosen.mu_boundary,
            without=frozenset(filter(None, chosen.without.split(","))),
            time_limit_s=chosen.time_limit,
        ),
    )
    rows = np.array([measure_depth(file, options) for file in files])
    print(
        f"mean of {len(rows)}: lines {rows[:, 0].mean():.0f}, recall 5 % {rows[:, 5].mean():.3f}, "
        f"precision 5 % {rows[:, 7].mean():.3f} (lowest {rows[:, 7].min():.3f})"
    )


if __name__ == "__main__":
    main()
