"""The places of bodies, judged by many tables: python tests/benchmarks/ties_tables.py DATASET ... [--draws N]

What ties.py measures by one table for each scene moves by a body or two from one set of scenes to the next. Here each
draw leaves out some of the made scenes at random. The real datasets are placed by tables fitted to what is left without
them, the made scenes that were left out by one more. Prints means and standard deviations over the draws. `--write`
puts the mean of the tables of the real datasets into linecad/ties/table.py: mean log-odds of many fits.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from ties import Rows, Table, judge_all, placed, rows_of, tables, write_table
from ties_truth import Judged

from linecad.arrays import Int
from linecad.ties.candidates import KINDS, Kind

KEPT = 0.7  # of the made scenes, in each draw


def table_without(rows: dict[Kind, Rows], left_out: Int) -> Table:
    """The fit to all scenes but those numbers."""
    return tables({kind: of_kind.fit(~np.isin(of_kind.scene, left_out)) for kind, of_kind in rows.items()}, rows)


def mean_table(several: list[Table]) -> Table:
    """The table whose log-odds are the mean of those of several."""
    kinds = {kind: list(slopes) for kind, slopes in several[0]["LOG_ODDS"].items()}
    return {
        "AT_ONCE": {kind: float(np.mean([table["AT_ONCE"][kind] for table in several])) for kind in kinds},
        "LOG_ODDS": {
            kind: {name: float(np.mean([table["LOG_ODDS"][kind][name] for table in several])) for name in names}
            for kind, names in kinds.items()
        },
    }


def left_out(photos: list[Judged], random: np.random.Generator) -> Int:
    """The numbers of the made scenes that one draw leaves out."""
    scenes = sorted({photo.scene for photo in photos})
    order: Int = random.permutation(sorted({scenes.index(photo.scene) for photo in photos if photo.is_made}))
    return order[round(KEPT * len(order)) :]


def judge_by_one(
    photos: list[Judged], rows: dict[Kind, Rows], out: Int, pool: ProcessPoolExecutor
) -> dict[str, tuple[float, float]]:
    """Mean recall and precision of each dataset by tables that saw neither it nor the scenes that are left `out`."""
    scenes = sorted({photo.scene for photo in photos})
    without = {scene: np.append(out, scenes.index(scene)) for scene in scenes}
    is_made = {photo.scene: photo.is_made for photo in photos}
    judged = [photo for photo in photos if not is_made[photo.scene] or scenes.index(photo.scene) in out]
    of_made = table_without(rows, out)
    table = {scene: of_made if is_made[scene] else table_without(rows, without[scene]) for scene in scenes}
    jobs = [pool.submit(placed, photo, (), table[photo.scene]) for photo in judged]
    found: dict[str, list[tuple[float, float]]] = {}
    for photo, job in zip(judged, jobs, strict=True):
        found.setdefault(photo.dataset, []).append(job.result().score)
    return {name: tuple(np.mean(scores, axis=0).tolist()) for name, scores in found.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--draws", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--write", action="store_true", help="the mean of the tables into linecad/ties/table.py")
    chosen = parser.parse_args()
    with ProcessPoolExecutor(chosen.workers) as pool:
        photos = judge_all(chosen.datasets, pool)
        rows = {kind: rows_of(photos, kind) for kind in KINDS}
        random = np.random.default_rng(7)
        outs = [left_out(photos, random) for _ in range(chosen.draws)]
        draws = [judge_by_one(photos, rows, out, pool) for out in outs]
    print("\n| dataset | recall | precision |\n| --- | --- | --- |")
    for name in draws[0]:
        scores = np.array([draw[name] for draw in draws])
        cells = [
            f"{mean:.3f} ± {spread:.3f}" for mean, spread in zip(scores.mean(axis=0), scores.std(axis=0), strict=True)
        ]
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    if chosen.write:
        scenes = sorted({photo.scene for photo in photos})
        real = sorted({scenes.index(photo.scene) for photo in photos if not photo.is_made})
        write_table(mean_table([table_without(rows, np.append(out, scene)) for out in outs for scene in real]))


if __name__ == "__main__":
    main()
