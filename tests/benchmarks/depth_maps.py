"""Depth maps of made and real photos with simulated errors: python tests/benchmarks/depth_maps.py DATASET ...

DATASET is a folder that `linecad evaluate` knows and whose truth has depth. Prints, with the tables as they are in
linecad/ties, recall and precision at 5 % of everything for widths of the walls' errors; how many of the points that are
right within 2 % without a map still are with it, on lines of bodies that other ties hold to the reference; how often
maps that are of no use are left out; and whether the kind is told where the file does not tell it.
"""

import argparse
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
from ties import place_bodies
from ties_truth import Judged, densest, judge

from linecad.arrays import Bool
from linecad.dataset.depth_maps import MapKind
from linecad.depth.depth_map import DepthMap, Single
from linecad.errors import DepthMapError
from linecad.evaluation.datasets import find_dataset
from linecad.ties.placing import BodyPlaces

WIDTHS = (0.005, 0.012, 0.02, 0.035, 0.05, 0.08)
EXACT = 0.02  # relative depth
SAME_DEPTH = 0.003  # log, by which a map of one depth varies


@dataclass(frozen=True, eq=False)
class Outcome:
    """One photo with one map."""

    score: tuple[float, float]  # recall and precision at 5 %
    heard: str  # "" where the map was used, else why not
    width: float  # as estimated; NaN where it was not heard
    kept: tuple[int, int]  # points that were right within 2 % by firm ties alone, and how many of them still are
    kind: str


def with_map(photo: Judged, width: float, seed: int, kind: MapKind, is_told: bool, other: Judged | None) -> Outcome:
    """The photo with a simulated map; of the `other` photo where one is given."""
    source = photo if other is None else other
    drawn = source.true_depth.simulated(width, seed, kind, is_told)
    values = drawn.values if other is None else _stretched(drawn, photo)
    return _outcome(photo, DepthMap("simulated", values, values > 0, drawn.kind))


def of_no_use(photo: Judged, seed: int, is_constant: bool) -> Outcome:
    """The photo with a map of one depth, or with depths at random."""
    true, rng = photo.true_depth, np.random.default_rng(seed)
    if is_constant:
        values = np.exp(rng.normal(1.0, SAME_DEPTH, true.depth.shape)).astype(np.float32)
    else:
        values = rng.permutation(np.nan_to_num(true.depth).ravel()).reshape(true.depth.shape).astype(np.float32)
    return _outcome(photo, true.of_values(values, "z"))


def _stretched(drawn: DepthMap, photo: Judged) -> Single:
    width, height = photo.true_depth.size
    rows = (np.arange(height) * drawn.height) // height
    columns = (np.arange(width) * drawn.width) // width
    return drawn.values[np.ix_(rows, columns)]


def _outcome(photo: Judged, depth: DepthMap) -> Outcome:
    try:
        found = place_bodies(photo, photo.candidates, depth)
    except DepthMapError as error:
        return Outcome((np.nan, np.nan), f"refused: {error}", np.nan, (0, 0), "")
    without = place_bodies(photo, photo.candidates)
    before, after = _exact(photo, without), _exact(photo, found)
    firm = _held(photo, without) & before
    kept = (int(firm.sum()), int((firm & after).sum()))
    heard = found.evidence.heard
    if isinstance(heard, str):
        return Outcome(photo.score(found.log_depth), heard, np.nan, kept, "")
    return Outcome(photo.score(found.log_depth), "", heard.width, kept, heard.reading.kind)


def _exact(photo: Judged, places: BodyPlaces) -> Bool:
    """Mask of the points seen whose depth is right within EXACT relative to the reference body."""
    line = photo.on[photo.seen]
    error = places.log_depth[line] + photo.log_factor[photo.seen] - photo.log_true[photo.seen]
    of_reference = error[photo.setting.bodies.body[line] == places.evidence.reference]
    middle = densest(of_reference if len(of_reference) else error)
    return np.asarray(np.abs(np.expm1(error - middle)) < EXACT)


def _held(photo: Judged, places: BodyPlaces) -> Bool:
    """Mask of the points seen on lines of bodies that ties which count hold to the reference, without a map."""
    part = places.ties.parts(places.placement.counted, len(places.placement.log_scale))
    return np.asarray((part == part[places.evidence.reference])[photo.setting.bodies.body[photo.on[photo.seen]]])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--seeds", type=int, default=2, help="maps of each photo and width")
    chosen = parser.parse_args()
    with ProcessPoolExecutor(chosen.workers) as pool:
        for folder in chosen.datasets:
            jobs = [pool.submit(judge, folder.name, case) for case in find_dataset(folder).cases]
            photos = [photo for job in jobs if (photo := job.result()) is not None]
            _print_dataset(folder.name, photos, chosen.seeds, pool)


def _print_dataset(name: str, photos: list[Judged], seeds: int, pool: ProcessPoolExecutor) -> None:
    without = np.mean([photo.score(place_bodies(photo, photo.candidates).log_depth) for photo in photos], axis=0)
    print(f"\n{name}: {len(photos)} photos, without a map {without[0]:.3f} / {without[1]:.3f}\n")
    print("| map | recall / precision at 5 % | heard | width found, median | right within 2 % that stay so |")
    print("| --- | --- | --- | --- | --- |")
    for width in WIDTHS:
        _print_row(f"{width:.1%}", [
            pool.submit(with_map, photo, width, seed, "z", True, None) for seed in range(seeds) for photo in photos
        ])  # fmt: skip
    kinds: tuple[MapKind, ...] = get_args(MapKind)
    for kind in kinds:
        found = _print_row(f"1.2%, {kind}, untold", [
            pool.submit(with_map, photo, 0.012, 0, kind, False, None) for photo in photos
        ])  # fmt: skip
        right = sum(one.kind == kind for one in found)
        refused = sum(one.heard.startswith("refused") for one in found)
        print(f"({right} kinds right, {refused} refused)")
    others = [photos[(number + len(photos) // 2) % len(photos)] for number in range(len(photos))]
    _print_row("of another photo", [
        pool.submit(with_map, photo, 0.012, 0, "z", True, other) for photo, other in zip(photos, others, strict=True)
    ])  # fmt: skip
    for label, is_constant in (("of one depth", True), ("at random", False)):
        _print_row(label, [pool.submit(of_no_use, photo, 0, is_constant) for photo in photos])


def _print_row(label: str, jobs: list[Future[Outcome]]) -> list[Outcome]:
    found = [job.result() for job in jobs]
    known = [one for one in found if np.isfinite(one.score[0])]
    recall, precision = np.mean([one.score for one in known], axis=0) if known else (np.nan, np.nan)
    heard = [one for one in found if not one.heard]
    width = np.median([one.width for one in heard]) if heard else np.nan
    before, after = (sum(one.kept[part] for one in found) for part in range(2))
    share = f"{after / before:.3f}" if before else ""
    print(
        f"| {label} | {recall:.3f} / {precision:.3f} | {len(heard)} of {len(found)} | {width:.3f} | {share} |",
        flush=True,
    )
    return found


if __name__ == "__main__":
    main()
