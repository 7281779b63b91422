"""What tells windows and doors: python tests/benchmarks/openings.py DATASET ... [--unseen DATASET ...] [--write]

DATASET is a folder of scenes that `linecad dataset`, rough_brick.py or high_rises.py made. Solves each photo, takes
the rectangles that are judged in each wall, and fits the networks of `linecad.model.openings.odds` to whether they lie
on a true opening. Each dataset is judged by the fit of the others, an --unseen one by that of all. Prints the average
precision of the log-odds as they are and as they are fitted, by the evidence alone and beside the others. Needs torch.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import numpy as np
import opening_network
import shapely

import linecad.model.openings.find
from linecad.arrays import Float, Int
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.openings import shape_in_photo
from linecad.evaluation.references import open_case
from linecad.model.openings import evidence, neighbours
from linecad.model.openings.evidence import measure
from linecad.model.openings.find import shapes_of
from linecad.model.openings.neighbours import compare
from linecad.model.openings.odds import WEIGHTS, Network, log_odds_alone, log_odds_beside, write_networks
from linecad.model.openings.pool import Pool, build_pool
from linecad.model.openings.raster import Raster, Sight, build_raster
from linecad.model.openings.rectangles import find_rectangles
from linecad.model.openings.walls import Wall
from linecad.options import Options
from linecad.pipeline import reconstruct

BY_ITSELF = (0.72, 0.60)  # overlap with a true opening, from which a rectangle is one, and below which it is none
BESIDE = (0.66, 0.53)  # the same beside the others
TOUCHED = 0.02  # overlap, from which a false one counts twice: it takes the place of a true one


@dataclass(frozen=True, eq=False)
class Rows:
    """The rectangles of one photo."""

    dataset: str
    first: Float  # (N, F) evidence of all that edges close
    first_overlap: Float  # (N,) intersection over union with the truest opening
    whole: Float  # (M, F + G) evidence of those that are judged, and how they lie to the others
    overlap: Float  # (M,)


def overlaps(wall: Wall, raster: Raster, box: Int, true: np.ndarray) -> Float:
    """(N,) of boxes (N, 4) with those of true openings, polygons (O,) in the photo, that they share most with."""
    shapes = np.array(shapes_of(wall, raster, box), object)
    one, other = shapely.STRtree(true).query(shapes, predicate="intersects").reshape(2, -1)
    shared = shapely.area(shapely.intersection(shapes[one], true[other]))
    found = np.zeros(len(box))
    np.maximum.at(found, one, shared / (shapely.area(shapes[one]) + shapely.area(true[other]) - shared))
    return found


def rows_of(dataset: str, case: Case) -> Rows | None:
    """None where the photo shows no opening or no wall."""
    photo, reference = open_case(case)
    truth = reference.truth
    walls: list[Wall] = []
    pools: list[tuple[Wall, Pool]] = []

    def raster_of(wall: Wall, sight: Sight) -> Raster | None:
        walls.append(wall)
        return build_raster(wall, sight)

    def pool_of(raster: Raster) -> Pool:
        pool = build_pool(raster)
        pools.append((walls[-1], pool))
        return pool

    module = linecad.model.openings.find
    with mock.patch.object(module, "build_raster", raster_of), mock.patch.object(module, "build_pool", pool_of):
        reconstruct(photo, Options())
    assert truth is not None
    assert truth.openings is not None, "the truth of these scenes tells no openings"
    shown = [shape_in_photo(truth, corners) for corners in truth.openings.corners]
    true = np.array([shape for shape in shown if shape is not None], object)
    if not len(true) or not pools:
        return None
    closed = [find_rectangles(pool.raster, pool.edges) for _, pool in pools]
    return Rows(
        dataset,
        np.concatenate(
            [measure(box, pool.edges, pool.sums, pool.raster) for box, (_, pool) in zip(closed, pools, strict=True)]
        ),
        np.concatenate(
            [overlaps(wall, pool.raster, box, true) for box, (wall, pool) in zip(closed, pools, strict=True)]
        ),
        np.concatenate(
            [
                np.column_stack([pool.evidence, compare(pool.box, pool.raster, pool.others, pool.other_log_odds)])
                for _, pool in pools
            ]
        ),
        np.concatenate([overlaps(wall, pool.raster, pool.box, true) for wall, pool in pools]),
    )


def split(features: list[Float], overlap: list[Float], bounds: tuple[float, float]) -> tuple[Float, Float, Float]:
    """Features and whether they are right of those rectangles that clearly are one or none, and their overlap."""
    every, share = np.concatenate(features), np.concatenate(overlap)
    clear = (share >= bounds[0]) | (share < bounds[1])
    return every[clear], (share[clear] >= bounds[0]).astype(float), share[clear]


def first_of(rows: list[Rows]) -> tuple[Float, Float, Float]:
    """By the evidence alone."""
    return split([each.first for each in rows], [each.first_overlap for each in rows], BY_ITSELF)


def whole_of(rows: list[Rows]) -> tuple[Float, Float, Float]:
    """Beside the others."""
    return split([each.whole for each in rows], [each.overlap for each in rows], BESIDE)


def fits_to(rows: list[Rows]) -> tuple[Network, Network]:
    """By the evidence alone, and beside the others."""
    features, right, _ = first_of(rows)
    first = opening_network.train(evidence.NAMES, features, right, np.ones(len(right)))
    features, right, overlap = whole_of(rows)
    weight = np.where((right == 0) & (overlap > TOUCHED), 2.0, 1.0)
    return first, opening_network.train((*evidence.NAMES, *neighbours.NAMES), features, right, weight)


def average_precision(right: Float, value: Float) -> float:
    """Mean over the right ones of the precision among those that are not worth less."""
    ordered = right[np.argsort(-value, kind="stable")]
    return float((np.cumsum(ordered) / np.arange(1, len(ordered) + 1) * ordered).sum() / ordered.sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--unseen", nargs="*", type=Path, default=[], help="datasets that no fit sees")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--write", action="store_true", help="the fits into linecad/model/openings/odds.npz")
    chosen = parser.parse_args()
    folders = [*chosen.datasets, *chosen.unseen]
    with ProcessPoolExecutor(chosen.workers) as pool:
        jobs = [pool.submit(rows_of, folder.name, case) for folder in folders for case in find_dataset(folder).cases]
        rows = [row for job in jobs if (row := job.result()) is not None]
    unseen = {folder.name for folder in chosen.unseen}
    print("| dataset | rectangles | by themselves, as it is | fitted | beside the others, as it is | fitted |")
    print("| --- | --- | --- | --- | --- | --- |")
    for folder in folders:
        own = [row for row in rows if row.dataset == folder.name]
        others = [row for row in rows if row.dataset not in unseen | {folder.name}]
        if not own or not others:
            continue
        first, whole = fits_to(others)
        cells = [folder.name, str(sum(len(each.whole) for each in own))]
        for fitted, (features, right, _), now in (
            (first, first_of(own), log_odds_alone),
            (whole, whole_of(own), lambda both: log_odds_beside(both, both[:, :0])),
        ):
            cells.append(f"{average_precision(right, now(features)):.3f}")
            cells.append(f"{average_precision(right, fitted.log_odds(features)):.3f}")
        print("| " + " | ".join(cells) + " |")
    if chosen.write:
        # What is judged follows from the first ones: write, then fit the others once more.
        write_networks(*fits_to([row for row in rows if row.dataset not in unseen]), WEIGHTS)


if __name__ == "__main__":
    main()
