"""Who is right about parts of bodies, a map or crossings: python tests/benchmarks/map_parts.py DATASET ... [--write]

DATASET is a folder that `linecad evaluate` knows and whose truth has depth. Places each photo with simulated maps of
WIDTHS, finds the parts of bodies that the map has elsewhere, and fits the log-odds of `linecad.ties.depth_parts` to
those where one of both is right; each dataset is judged by the fit of the others, and an --unseen one by that of all.
Prints for each dataset and width what the moves gain, in points of a hundred within 5 % (of all, and of those that
lines show), and how often what was moved is right and is called so.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import logistic
import numpy as np
from probability import write
from scipy.special import expit
from ties import place_bodies
from ties_truth import Judged, judge

import linecad.ties.depth_parts
from linecad.errors import DepthMapError
from linecad.evaluation.datasets import find_dataset
from linecad.ties.depth_parts import LOG_ODDS, MOST_KNOWN, WIDEST, find_parts, hear_lines
from linecad.ties.depth_ties import DepthWitness

WIDTHS = (0.012, 0.035, 0.08)
SEED = 0
RIGHT = 0.05  # relative depth
RIDGE = 3.0


@dataclass(frozen=True, eq=False)
class Rows:
    """The parts of one photo with one map."""

    dataset: str
    width: float  # of the map that was drawn
    found: float  # in the program
    features: np.ndarray  # (M, F)
    known: np.ndarray  # (M,)
    points: np.ndarray  # (M,) that its lines show
    before: np.ndarray  # (M,) of them within RIGHT as it stands
    after: np.ndarray  # (M,) and where the map has it
    all_points: int
    seen: int  # of them, on lines


def rows_of(photo: Judged, width: float) -> Rows | None:
    """None where the map is not heard."""
    try:
        placed = place_bodies(photo, photo.candidates, photo.true_depth.simulated(width, SEED, "z", True))
    except DepthMapError:
        return None
    heard, mapped, setting = placed.evidence.heard, placed.mapped, placed.evidence.setting
    if not isinstance(heard, DepthWitness) or mapped is None:
        return None
    found, depth = heard.width_of_parts, setting.sight.depth
    assert depth is not None
    asked = hear_lines(setting, depth, heard.reading)
    parts = find_parts(setting, asked, mapped.log_scale, mapped.of_map, placed.probability)
    seen = photo.seen
    line = photo.on[seen]
    error = placed.log_depth[line] + photo.log_factor[seen] - photo.log_true[seen]
    error -= np.median(error)
    own = [np.isin(line, [*part.lines, *part.also]) for part in parts]
    right = [np.abs(np.expm1(error[each])) < RIGHT for each in own]
    moved = [np.abs(np.expm1(error[each] + part.move)) < RIGHT for part, each in zip(parts, own, strict=True)]
    return Rows(
        photo.dataset,
        width,
        found,
        np.array([list(part.features(found).values()) for part in parts]).reshape(-1, len(LOG_ODDS)),
        np.array([part.known for part in parts]),
        np.array([each.sum() for each in own], float),
        np.array([each.sum() for each in right], float),
        np.array([each.sum() for each in moved], float),
        len(photo.on),
        len(seen),
    )


def fits_to(rows: list[Rows]) -> tuple[logistic.Logistic, logistic.Logistic]:
    """Who is right where one is, a part weighing what it changes; and whether what is moved is."""
    features = np.concatenate([each.features for each in rows])
    gain = np.concatenate([(each.after - each.before) / each.all_points for each in rows])
    told = gain != 0
    weight = np.abs(gain[told]) / np.abs(gain[told]).mean()
    who = logistic.fit(features[told], (gain[told] > 0).astype(float), RIDGE, weight)
    moved = [is_moved(each, who) & (each.points > 0) for each in rows]
    share = np.concatenate(
        [(each.after / np.maximum(each.points, 1))[own] for each, own in zip(rows, moved, strict=True)]
    )
    weight = np.concatenate([(each.points / each.all_points)[own] for each, own in zip(rows, moved, strict=True)])
    by_width = np.array(list(LOG_ODDS)) == "width"
    moved_features = np.concatenate([each.features[own] for each, own in zip(rows, moved, strict=True)])
    return who, logistic.fit(moved_features[:, by_width], share, RIDGE, weight / weight.mean())


def is_moved(rows: Rows, who: logistic.Logistic) -> np.ndarray:
    """(M,)"""
    return (who.probability(rows.features) > 0.5) & (rows.known < MOST_KNOWN) & (rows.found < WIDEST)


def print_dataset(rows: list[Rows], who: logistic.Logistic, moved: logistic.Logistic, photos: int) -> None:
    """One row for each width; photos whose map is not heard gain nothing."""
    by_width = list(LOG_ODDS).index("width")
    for width in WIDTHS:
        own = [each for each in rows if each.width == width]
        if not own:
            continue
        gains, right, said, points = [], 0.0, 0.0, 0.0
        for each in own:
            chosen = is_moved(each, who)
            change = (each.after - each.before)[chosen].sum()
            gains.append((change / each.all_points, change / max(each.seen, 1)))
            right += each.after[chosen].sum()
            points += each.points[chosen].sum()
            said += (each.points[chosen] * moved.probability(each.features[chosen][:, [by_width]])).sum()
        gain = 100 * np.sum(gains, axis=0) / photos
        found = np.quantile([each.found for each in own], [0.1, 0.5, 0.9])
        cells = " ".join(f"{each:.1%}" for each in found)
        row = [own[0].dataset, f"{width:.1%}", f"{len(own)} of {photos}", cells, f"{gain[0]:+.1f} / {gain[1]:+.1f}"]
        print("| " + " | ".join([*row, f"{right / max(points, 1):.2f}", f"{said / max(points, 1):.2f}"]) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--unseen", nargs="*", type=Path, default=[], help="datasets that no fit sees")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--write", action="store_true", help="the fits into linecad/ties")
    chosen = parser.parse_args()
    folders = [*chosen.datasets, *chosen.unseen]
    with ProcessPoolExecutor(chosen.workers) as pool:
        jobs = [pool.submit(judge, folder.name, case) for folder in folders for case in find_dataset(folder).cases]
        photos = [photo for job in jobs if (photo := job.result()) is not None]
        found = [pool.submit(rows_of, photo, width) for photo in photos for width in WIDTHS]
        rows = [row for job in found if (row := job.result()) is not None]
    unseen = {folder.name for folder in chosen.unseen}
    print("| dataset | width | heard | width found | gain | moved and right | called so |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for folder in folders:
        others = [row for row in rows if row.dataset not in unseen | {folder.name}]
        count = sum(photo.dataset == folder.name for photo in photos)
        if others:
            print_dataset([row for row in rows if row.dataset == folder.name], *fits_to(others), count)
    who, moved = fits_to([row for row in rows if row.dataset not in unseen])
    slopes = dict(zip(LOG_ODDS, who.slope.round(4).tolist(), strict=True))
    print(f"who is right: {who.at_once:.4f} {slopes}; moved: {moved.at_once:.4f}, {moved.slope[0]:.4f} by width")
    print(f"at the usual width {expit(moved.at_once):.2f} of what is moved is right")
    if chosen.write:
        write(linecad.ties.depth_parts, "", who)
        write(linecad.ties.depth_parts, "MOVED_", moved)


if __name__ == "__main__":
    main()
