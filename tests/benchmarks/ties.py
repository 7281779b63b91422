"""What ties bodies, fitted and measured on photos of known depth: python tests/benchmarks/ties.py DATASET ...

DATASET is a folder that `linecad evaluate` knows and whose truth has depth. A candidate (linecad.ties.candidates) is
right where its ratio is that of the true scales of its two bodies within 3 %. Prints how well each kind of evidence
tells right from wrong, what each is worth to the placement, and how far the probabilities of lines hold. All of it is
cross-validated: a scene is judged by the others; the photos of one real dataset are one scene, and so are their parts
(parts.py). One table tells little: ties_tables.py judges by many, and writes the mean of them. `--write` puts the
probabilities fitted to all photos into linecad/ties/probability.py.
"""

import argparse
import re
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from unittest import mock

import logistic
import numpy as np
from parts import PARTS
from ties_truth import PARTED, Judged, densest, judge

import linecad.ties.placing
import linecad.ties.probability
import linecad.ties.table
import linecad.ties.weights
from linecad.arrays import Float, Int
from linecad.depth.depth_map import DepthMap
from linecad.evaluation.datasets import find_dataset
from linecad.ties.candidates import KINDS, Candidate, Kind
from linecad.ties.placing import BodyPlaces
from linecad.ties.probability import features
from solver.options import SolveOptions

RIGHT = 0.03  # log ratio of a candidate
RIGHT_DEPTH = 0.05
LEAST_REFERENCE = 10  # points on the reference body, for the others to be relative to
RIDGE, RIDGE_OF_LINES = 3.0, 30.0
SURE = 0.9
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


def judge_all(folders: list[Path], pool: ProcessPoolExecutor) -> list[Judged]:
    """The photos of datasets, and the parts of real ones."""
    jobs = [
        pool.submit(judge, folder.name, case, part)
        for folder in folders
        for case in find_dataset(folder).cases
        for part in ([None] if case.kind == "made" else [None, *PARTS])
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


def tables(fits: Fits, rows: dict[Kind, Rows]) -> dict[str, dict]:
    """The same in the form of linecad.ties.table."""
    slopes = {
        kind: dict(zip(rows[kind].names, fitted.slope.tolist(), strict=True)) for kind, fitted in fits.items()
    }  # fmt: skip
    return {"AT_ONCE": {kind: fitted.at_once for kind, fitted in fits.items()}, "LOG_ODDS": slopes}


def place_bodies(photo: Judged, candidates: list[Candidate], depth: DepthMap | None = None) -> BodyPlaces:
    """The placement by some candidates and a depth map."""
    setting = replace(photo.setting, sight=replace(photo.setting.sight, depth=depth))
    nothing_told = np.zeros(len(setting.graph.edges), bool)
    options = SolveOptions(node_limit=FEW_NODES if photo.is_part else None)
    return linecad.ties.placing.place_bodies(setting, candidates, nothing_told, options)


@dataclass(frozen=True, eq=False)
class Placed:
    """A photo with its bodies in their places."""

    score: tuple[float, float]  # recall and precision at 5 %
    proven: bool
    heard: bool  # a depth map was given and used
    features: Float  # (P, F) of the lines at the points that are judged; none where the reference body shows too few
    right: Float  # (P,) 0 or 1


def placed(
    photo: Judged, kinds: tuple[Kind, ...], table: dict[str, dict], depth: tuple[float, int] | None = None
) -> Placed:
    """The photo placed by a table, without the candidates of some kinds, and with a map of that width and seed."""
    setting = photo.setting
    candidates = [candidate for candidate in photo.candidates if candidate.kind not in kinds]
    with mock.patch.multiple(linecad.ties.weights, **table):
        places = place_bodies(photo, candidates, depth and photo.true_depth.simulated(*depth))
    placement, reference, log_depth = places.placement, places.reference, places.log_depth
    body = setting.bodies.body
    known = features(setting, placement, reference, log_depth, places.mapped)
    seen = photo.seen
    line = photo.on[seen]
    error = log_depth[line] + photo.log_factor[seen] - photo.log_true[seen]
    if (body[line] == reference).sum() < LEAST_REFERENCE:
        line, error = line[:0], error[:0]
    else:
        error = error - densest(error[body[line] == reference])
    right = np.abs(np.expm1(error)) < RIGHT_DEPTH
    of_lines = np.array([value[line] for value in known.values()]).T
    is_proven, is_heard = placement.status == "optimal", places.mapped is not None
    return Placed(photo.score(log_depth), is_proven, is_heard, of_lines, right.astype(np.float64))


def print_ablation(
    photos: list[Judged], rows: dict[Kind, Rows], datasets: list[str], pool: ProcessPoolExecutor
) -> list[Placed]:
    """Print a row for each part of the evidence; the placements with all of it."""
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
    return complete


def print_maps(
    photos: list[Judged], rows: dict[Kind, Rows], datasets: list[str], pool: ProcessPoolExecutor
) -> list[list[Placed]]:
    """Print a row for simulated depth maps of each of WIDTHS; the placements with them."""
    print("\n| with a depth map | " + " | ".join(datasets) + " |\n| --- " + "| --- " * len(datasets) + "|")
    scenes = sorted({photo.scene for photo in photos})
    table = {scene: tables(fits_without(photos, rows, scene, ()), rows) for scene in scenes}
    found = []
    for width in WIDTHS:
        jobs = [pool.submit(placed, photo, (), table[photo.scene], (width, seed)) for seed, photo in enumerate(photos)]
        found.append([job.result() for job in jobs])
        _print_row(f"{width:.1%}", photos, [one.score for one in found[-1]], datasets)
        heard = sum(one.heard for one in found[-1])
        print(f"{heard} of {len(photos)} maps are heard, {sum(one.proven for one in found[-1])} proven", flush=True)
    return found


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


def print_probabilities(known: list[tuple[str, Judged, Placed]]) -> logistic.Logistic:
    """Print how far the probabilities of lines hold, by the names given; the regression over all, each of one weight.

    All with a map that is heard, or all without one. A scene is left out with all its maps.
    """
    known = [one for one in known if len(one[2].right)]
    of_lines = np.concatenate([one.features for _, _, one in known])
    right = np.concatenate([one.right for _, _, one in known])
    weight = np.concatenate([np.full(len(one.right), 1 / len(one.right)) for _, _, one in known])
    weight /= weight.mean()
    scene = np.concatenate([np.full(len(one.right), photo.scene) for _, photo, one in known])
    dataset = np.concatenate([np.full(len(one.right), name) for name, _, one in known])
    predicted = np.zeros(len(right))
    for name in np.unique(scene):
        out = scene == name
        fitted = logistic.fit(of_lines[~out], right[~out], RIDGE_OF_LINES, weight[~out])
        predicted[out] = fitted.probability(of_lines[out])
    print("\n| lines | " + " | ".join(f"{tenth / 10:.1f}" for tenth in range(10)) + " | at 0.9: precision | recall |")
    print("| --- " * 13 + "|")
    for name in dict.fromkeys(name for name, _, _ in known):
        own = dataset == name
        cells = [_cell(tenth) for tenth in logistic.tenths(right[own], predicted[own], weight[own])]
        sure = own & (predicted >= SURE)
        share = (weight[sure] * right[sure]).sum() / (weight[own] * right[own]).sum()
        precision = np.average(right[sure], weights=weight[sure]) if sure.any() else np.nan
        print(f"| {name} | " + " | ".join([*cells, f"{precision:.3f}", f"{share:.2f}"]) + " |", flush=True)
    return logistic.fit(of_lines, right, RIDGE_OF_LINES, weight)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--write", action="store_true", help="the fits into linecad/ties/probability.py")
    chosen = parser.parse_args()
    with ProcessPoolExecutor(chosen.workers) as pool:
        photos = judge_all(chosen.datasets, pool)
        datasets = list(dict.fromkeys(photo.dataset for photo in photos))
        rows = {kind: rows_of(photos, kind) for kind in KINDS}
        print_kinds(rows, datasets)
        found = print_ablation(photos, rows, datasets, pool)
        whole = [photo for photo in photos if not photo.is_part]
        with_maps = print_maps(whole, rows, [name for name in datasets if PARTED not in name], pool)
    of_lines = print_probabilities([
        (photo.dataset, photo, one) for photo, one in zip(photos, found, strict=True) if not photo.is_part
    ])  # fmt: skip
    of_maps = print_probabilities([
        (f"{photo.dataset}, map", photo, one)
        for of_width in with_maps for photo, one in zip(whole, of_width, strict=True) if one.heard
    ])  # fmt: skip
    print_changes(of_lines, of_maps)
    if chosen.write:
        write_probability(of_lines, of_maps)


def print_changes(of_lines: logistic.Logistic, of_maps: logistic.Logistic) -> None:
    """By how much the fits to all photos differ from what the project has, at most."""
    now = linecad.ties.probability
    for what, known, fitted in (
        ("lines", [now.AT_ONCE, *now.LOG_ODDS.values()], of_lines),
        ("lines with a map", [now.WITH_MAP_AT_ONCE, *now.WITH_MAP_LOG_ODDS.values()], of_maps),
    ):
        change = np.array(known) - np.r_[fitted.at_once, fitted.slope]
        print(f"{what}: the fit differs from the table by up to {np.abs(change).max():.4f}")


def write_table(table: dict[str, dict]) -> None:
    path = Path(linecad.ties.table.__file__)
    head = path.read_text(encoding="utf-8").partition("AT_ONCE")[0]
    lines = ["AT_ONCE: dict[Kind, float] = {"]
    lines += [f'    "{kind}": {value:.4f},' for kind, value in table["AT_ONCE"].items()]
    lines += ["}", "LOG_ODDS: dict[Kind, dict[str, float]] = {"]
    for kind, slopes in table["LOG_ODDS"].items():
        lines += [f'    "{kind}": {{', *(f'        "{name}": {value:.4f},' for name, value in slopes.items()), "    },"]
    path.write_text(head + "\n".join([*lines, "}", ""]), encoding="utf-8")


def write_probability(of_lines: logistic.Logistic, of_maps: logistic.Logistic) -> None:
    path = Path(linecad.ties.probability.__file__)
    text = path.read_text(encoding="utf-8")
    now = linecad.ties.probability
    for prefix, names, fitted in (("", now.LOG_ODDS, of_lines), ("WITH_MAP_", now.WITH_MAP_LOG_ODDS, of_maps)):
        slopes = "".join(
            f'    "{name}": {value:.4f},\n' for name, value in zip(names, fitted.slope.tolist(), strict=True)
        )
        table = f"{prefix}AT_ONCE = {fitted.at_once:.4f}\n{prefix}LOG_ODDS: dict[str, float] = {{\n{slopes}}}\n"
        text = re.sub(
            rf"^{prefix}AT_ONCE = .*?^}}\n",
            lambda _, table=table: table,
            text,
            count=1,
            flags=re.DOTALL | re.MULTILINE,
        )
    path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
