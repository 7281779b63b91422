"""What ties bodies, fitted and measured on photos of known depth: python tests/benchmarks/ties.py DATASET ...

DATASET is a folder that `linecad evaluate` knows and whose truth has depth. A candidate (linecad.ties.candidates) is
right where its ratio is that of the true scales of its two bodies within 3 %. Prints how well each kind of evidence
tells right from wrong and what each is worth to the placement. All of it is cross-validated: a scene is judged by the
others; the photos of one real dataset are one scene, and so are their parts (parts.py). One table tells little:
ties_tables.py judges by many, and writes the mean of them; probability.py fits how sure the places are.

`--refit KIND` instead fits one kind to whole photos, near what it is in the table of the project, and writes it there;
with `--only FEATURE` that feature alone, and what the kind has at once: to parts and views (views.py) of real photos
too, each dataset as heavy as any other.
"""

import argparse
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from unittest import mock

import logistic
import numpy as np
from parts import PARTS
from ties_truth import PARTED, Judged, judge
from views import VIEWS

import linecad.ties.placing
import linecad.ties.table
import linecad.ties.weights
from linecad.arrays import Float, Int
from linecad.depth.depth_map import DepthMap
from linecad.evaluation.datasets import find_dataset
from linecad.ties.candidates import KINDS, Candidate, Kind
from linecad.ties.depth_ties import hear
from linecad.ties.evidence import Evidence
from linecad.ties.placing import BodyPlaces
from solver.options import SolveOptions

RIGHT = 0.03  # log ratio of a candidate
RIDGE, RIDGE_NEAR = 3.0, 30.0
FEW_NODES = 300  # of the search on parts of photos, of which there are many
WIDTHS = (0.012, 0.035, 0.08)  # of simulated depth maps

# For each row of the ablation the kinds that are left out, and the features that the fit does without.
WITHOUT: dict[str, tuple[tuple[Kind, ...], tuple[str, ...]]] = {
    "all evidence": ((), ()),
    "bundles only": (("plane", "level", "ground"), ()),
    "without the ground": (("ground",), ()),
    "without planes": (("plane",), ("plane of it", "plane beside")),
    "without levels": (("level",), ("levels", "level excess", "level lead", "same eaves")),
    "without sizes": ((), ("size excess",)),
    "without colour": ((), ("colour",)),
    "without resampling": ((), ("supported", "connected")),
}
Fits = dict[Kind, logistic.Logistic]
Table = dict[str, Any]  # AT_ONCE and LOG_ODDS, as in linecad.ties.table


@dataclass(frozen=True, eq=False)
class Rows:
    """The candidates of one kind whose truth is known, of all photos."""

    names: list[str]  # of the features
    features: Float  # (M, F)
    right: Float  # (M,) 0 or 1
    dataset: list[str]
    scene: Int  # (M,)

    def fit(self, chosen: np.ndarray, without: tuple[str, ...] = ()) -> logistic.Logistic:
        """The regression over the chosen rows (M,)."""
        used = np.array([name not in without for name in self.names])
        return logistic.fit(self.features[chosen], self.right[chosen], RIDGE, used=used)


def judge_all(folders: list[Path], pool: ProcessPoolExecutor, parts: Iterable[str] = tuple(PARTS)) -> list[Judged]:
    """The photos of datasets, and these parts of real ones."""
    jobs = [
        pool.submit(judge, folder.name, case, part)
        for folder in folders
        for case in find_dataset(folder).cases
        for part in ([None] if case.kind == "made" else [None, *parts])
    ]
    photos = [photo for job in jobs if (photo := job.result()) is not None]
    print(f"{len(photos)} of {len(jobs)} photos and parts", flush=True)
    return photos


def rows_of(photos: list[Judged], kind: Kind) -> Rows:
    scenes = sorted({photo.scene for photo in photos})
    known = [
        (candidate, photo.error_of(candidate), photo)
        for photo in photos
        for candidate in photo.candidates
        if candidate.kind == kind and np.isfinite(photo.error_of(candidate))
    ]
    return Rows(
        list(known[0][0].features),
        np.array([list(candidate.features.values()) for candidate, _, _ in known]),
        np.array([float(error < RIGHT) for _, error, _ in known]),
        [photo.dataset for _, _, photo in known],
        np.array([scenes.index(photo.scene) for _, _, photo in known]),
    )


def print_kinds(rows: dict[Kind, Rows], datasets: list[str]) -> None:
    print("\n| kind | dataset | candidates | right | area under the curve | log loss |")
    print("| --- | --- | --- | --- | --- | --- |")
    calibration = ["| kind | " + " | ".join(f"{tenth / 10:.1f}" for tenth in range(10)) + " |", "| --- " * 11 + "|"]
    for kind, of_kind in rows.items():
        predicted = np.zeros(len(of_kind.right))
        for scene in np.unique(of_kind.scene):
            out = of_kind.scene == scene
            predicted[out] = of_kind.fit(~out).probability(of_kind.features[out])
        for dataset in datasets:
            own = np.array([name == dataset for name in of_kind.dataset])
            right, p = of_kind.right[own], predicted[own]
            if own.any():
                print(
                    f"| {kind} | {dataset} | {own.sum()} | {right.mean():.2f} | "
                    f"{logistic.area_under_curve(right, p):.3f} | {logistic.log_loss(right, p):.3f} |"
                )
        calibration.append(f"| {kind} | " + " | ".join(map(_cell, logistic.tenths(of_kind.right, predicted))) + " |")
    print("\n" + "\n".join(calibration), flush=True)


def _cell(tenth: tuple[float, float, int] | None) -> str:
    return "" if tenth is None else f"{tenth[0]:.2f} / {tenth[1]:.2f} ({tenth[2]})"


def fits_without(photos: list[Judged], rows: dict[Kind, Rows], left_out: str, without: tuple[str, ...]) -> Fits:
    """The fits to all scenes but one."""
    number = sorted({photo.scene for photo in photos}).index(left_out)
    return {kind: of_kind.fit(of_kind.scene != number, without) for kind, of_kind in rows.items()}


def tables(fits: Fits, rows: dict[Kind, Rows]) -> Table:
    """The same in the form of linecad.ties.table."""
    slopes = {
        kind: dict(zip(rows[kind].names, fitted.slope.tolist(), strict=True)) for kind, fitted in fits.items()
    }  # fmt: skip
    return {"AT_ONCE": {kind: fitted.at_once for kind, fitted in fits.items()}, "LOG_ODDS": slopes}


def place_bodies(photo: Judged, candidates: list[Candidate], depth: DepthMap | None = None) -> BodyPlaces:
    """The placement by some candidates and a depth map."""
    setting = replace(photo.setting, sight=replace(photo.setting.sight, depth=depth))
    told = np.zeros(len(setting.graph.edges), bool)
    seams = tuple(seam for seam, _ in photo.seams)
    heard = hear(setting, candidates, depth)
    reference = int(setting.bodies.size.argmax())
    evidence = Evidence(setting, tuple(candidates), seams, photo.pieces, heard, told, told, reference)
    options = SolveOptions(node_limit=FEW_NODES if photo.is_part else None)
    return linecad.ties.placing.place_bodies(evidence, options)


@dataclass(frozen=True, eq=False)
class Placed:
    """A photo with its bodies in their places."""

    score: tuple[float, float]  # recall and precision at 5 %
    proven: bool
    heard: bool  # a depth map was given and used
    places: BodyPlaces


def placed(photo: Judged, kinds: tuple[Kind, ...], table: Table, depth: tuple[float, int] | None = None) -> Placed:
    """The photo placed by a table, without the candidates of some kinds, and with a map of that width and seed."""
    candidates = [candidate for candidate in photo.candidates if candidate.kind not in kinds]
    with mock.patch.multiple(linecad.ties.weights, **table):
        places = place_bodies(photo, candidates, depth and photo.true_depth.simulated(*depth))
    is_proven, is_heard = places.placement.status == "optimal", places.mapped is not None
    return Placed(photo.score(places.log_depth), is_proven, is_heard, places)


def print_ablation(
    photos: list[Judged], rows: dict[Kind, Rows], datasets: list[str], pool: ProcessPoolExecutor
) -> None:
    """Print a row for each part of the evidence."""
    print("\n| recall / precision at 5 % | " + " | ".join(datasets) + " |\n| --- " + "| --- " * len(datasets) + "|")
    _print_row("the robust fit alone", photos, [photo.score(photo.setting.log_depth) for photo in photos], datasets)
    at_truth = [photo.score(at_true_scales(photo)) for photo in photos]
    _print_row("bodies at their true scales", photos, at_truth, datasets)
    complete: list[Placed] = []
    scenes = sorted({photo.scene for photo in photos})
    for name, (kinds, without) in WITHOUT.items():
        table = {scene: tables(fits_without(photos, rows, scene, without), rows) for scene in scenes}
        jobs = [pool.submit(placed, photo, kinds, table[photo.scene]) for photo in photos]
        found = [job.result() for job in jobs]
        _print_row(name, photos, [one.score for one in found], datasets)
        complete = complete or found
    whole = [one.proven for photo, one in zip(photos, complete, strict=True) if not photo.is_part]
    print(f"\nwith all evidence {sum(whole)} of {len(whole)} whole photos are proven", flush=True)


def print_maps(photos: list[Judged], rows: dict[Kind, Rows], datasets: list[str], pool: ProcessPoolExecutor) -> None:
    """Print a row for simulated depth maps of each of WIDTHS."""
    print("\n| with a depth map | " + " | ".join(datasets) + " |\n| --- " + "| --- " * len(datasets) + "|")
    scenes = sorted({photo.scene for photo in photos})
    table = {scene: tables(fits_without(photos, rows, scene, ()), rows) for scene in scenes}
    for width in WIDTHS:
        jobs = [pool.submit(placed, photo, (), table[photo.scene], (width, seed)) for seed, photo in enumerate(photos)]
        found = [job.result() for job in jobs]
        _print_row(f"{width:.1%}", photos, [one.score for one in found], datasets)
        heard = sum(one.heard for one in found)
        print(f"{heard} of {len(photos)} maps are heard, {sum(one.proven for one in found)} proven", flush=True)


def at_true_scales(photo: Judged) -> Float:
    """Log depths (N,); bodies whose scale is not known keep their place beside the largest whose scale is."""
    body, true_scale = photo.setting.bodies.body, photo.true_scale[:-1]
    known = np.isfinite(true_scale)
    if not known.any():
        return photo.setting.log_depth
    largest = int(np.where(known, photo.setting.bodies.size, 0).argmax())
    shift: Float = np.where(known, true_scale, true_scale[largest])[np.maximum(body, 0)]
    return photo.setting.log_depth + np.where(body >= 0, shift, 0.0)


def _print_row(name: str, photos: list[Judged], scores: list[tuple[float, float]], datasets: list[str]) -> None:
    cells = []
    for dataset in datasets:
        own = [one for photo, one in zip(photos, scores, strict=True) if photo.dataset == dataset]
        cells.append("{:.3f} / {:.3f}".format(*np.mean(own, axis=0)))
    print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--refit", choices=KINDS, help="a kind to fit anew")
    parser.add_argument("--only", metavar="FEATURE", help="of that kind, and leave the others as they are")
    chosen = parser.parse_args()
    if chosen.only is not None and chosen.only not in linecad.ties.table.LOG_ODDS.get(chosen.refit, {}):
        parser.error("--only names a feature of the kind of --refit, as linecad/ties/table.py has it")
    with ProcessPoolExecutor(chosen.workers) as pool:
        seen = tuple(PARTS) if chosen.refit is None else (*PARTS, *VIEWS) if chosen.only is not None else ()
        photos = judge_all(chosen.datasets, pool, seen)
        if chosen.refit is not None:
            write_table(refitted(rows_of(photos, chosen.refit), chosen.refit, chosen.only))
            return
        datasets = list(dict.fromkeys(photo.dataset for photo in photos))
        rows = {kind: rows_of(photos, kind) for kind in KINDS}
        print_kinds(rows, datasets)
        print_ablation(photos, rows, datasets, pool)
        whole = [photo for photo in photos if not photo.is_part]
        print_maps(whole, rows, [name for name in datasets if PARTED not in name], pool)


def refitted(rows: Rows, kind: Kind, only: str | None) -> Table:
    """The table of the project with one kind fitted anew, near what it is, or with one feature of it."""
    slopes, at_once = linecad.ties.table.LOG_ODDS, linecad.ties.table.AT_ONCE
    near = logistic.Logistic(at_once[kind], np.array([slopes[kind][name] for name in rows.names]))
    if only is None:
        fitted = logistic.fit(rows.features, rows.right, RIDGE_NEAR, near=near)
    else:
        fitted = with_one_anew(near, rows, list(rows.names).index(only))
    one = tables({kind: fitted}, {kind: rows})
    return {"AT_ONCE": at_once | one["AT_ONCE"], "LOG_ODDS": slopes | one["LOG_ODDS"]}


def with_one_anew(known: logistic.Logistic, rows: Rows, column: int) -> logistic.Logistic:
    """The same with the likeliest slope of one feature, and what is so at once, by Newton's method.

    Each dataset weighs the same.
    """
    found, own = known, np.column_stack([np.ones(len(rows.right)), rows.features[:, column]])
    names = [name.removesuffix(PARTED) for name in rows.dataset]
    _, number, size = np.unique(names, return_inverse=True, return_counts=True)
    weight = 1 / size[number]
    for _ in range(logistic.STEPS):
        p = found.probability(rows.features)
        curvature = (own.T * (weight * p * (1 - p))) @ own
        step = np.linalg.solve(curvature, own.T @ (weight * (rows.right - p)))
        slope = found.slope.copy()
        slope[column] += step[1]
        found = logistic.Logistic(found.at_once + float(step[0]), slope)
    return found


def write_table(table: Table) -> None:
    path = Path(linecad.ties.table.__file__)
    head = path.read_text(encoding="utf-8").partition("AT_ONCE")[0]
    lines = ["AT_ONCE: dict[Kind, float] = {"]
    lines += [f'    "{kind}": {value:.4f},' for kind, value in table["AT_ONCE"].items()]
    lines += ["}", "LOG_ODDS: dict[Kind, dict[str, float]] = {"]
    for kind, slopes in table["LOG_ODDS"].items():
        lines += [f'    "{kind}": {{', *(f'        "{name}": {value:.4f},' for name, value in slopes.items()), "    },"]
    path.write_text(head + "\n".join([*lines, "}", ""]), encoding="utf-8")


if __name__ == "__main__":
    main()
