"""How much better each method is than another on the same photos: python tests/benchmarks/paired.py A.json [B.json]

Reads what `linecad evaluate --json` wrote. Each row of table 1 is compared with the baseline of the first file, and the
rows of the second file (other weights, say) with the paper's program B+C+P of the first. Accuracies of single photos
differ much more than methods do, so differences are drawn photo by photo: their intervals are far narrower than those
of the accuracies themselves.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from linecad.evaluation.bootstrap import COVERED, DRAWS, SEED

Counts = dict[str, tuple[int, int]]  # by photo: real and all edges of its tree


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path, nargs="?")
    arguments = parser.parse_args()
    first = rows(arguments.first)
    print("| method | against | mean accuracy, points | normalised accuracy, points |")
    print("| --- | --- | --- | --- |")
    for name, counts in first.items():
        if name != "paper Baseline":
            print(line(name, counts, "Baseline", first["paper Baseline"]))
    for name, counts in (rows(arguments.second) if arguments.second else {}).items():
        print(line(f"{name}, second file", counts, "paper B+C+P", first["paper B+C+P"]))


def rows(file: Path) -> dict[str, Counts]:
    """The trees of every row of table 1."""
    found: dict[str, Counts] = {}
    for photo in json.loads(file.read_text(encoding="utf-8"))["photos"]:
        for formulation, methods in (photo.get("methods") or {}).items():
            for method, run in methods.items():
                decided = run["decisions"]
                counts = decided["tree_real"], decided["tree_real"] + decided["tree_fake"]
                found.setdefault(f"{formulation} {method}", {})[photo["name"]] = counts
    return found


def line(name: str, counts: Counts, other_name: str, other: Counts) -> str:
    photos = sorted(photo for photo in counts.keys() & other.keys() if counts[photo][1] and other[photo][1])
    one, two = (np.array([each[photo] for photo in photos], float) for each in (counts, other))
    drawn = np.random.default_rng(SEED).integers(0, len(photos), (DRAWS, len(photos)))
    mean = [difference(one[draw].sum(axis=0), two[draw].sum(axis=0)) for draw in (slice(None), *drawn)]
    normalised = [difference(*(each[draw].T for each in (one, two))) for draw in (slice(None), *drawn)]
    return f"| {name} | {other_name} | {estimate(mean)} | {estimate(normalised)} |"


def difference(one: np.ndarray, two: np.ndarray) -> float:
    """The mean difference of two shares, in points."""
    return 100 * float(np.mean(one[0] / one[1] - two[0] / two[1]))


def estimate(values: list[float]) -> str:
    """The first value with the interval of the others."""
    low, high = np.quantile(values[1:], [(1 - COVERED) / 2, (1 + COVERED) / 2])
    return f"{values[0]:+.1f} ({low:+.1f} to {high:+.1f})"


if __name__ == "__main__":
    main()
