"""What the made streets come to: python tests/benchmarks/describe.py [--sizes paper 640] [--count 10]."""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).resolve().parent)]

from instances import LADDER, make_instance


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", nargs="+", choices=list(LADDER), default=list(LADDER))
    parser.add_argument("--count", type=int, default=10, help="instances of each size, seeds 0, 1, ...")
    arguments = parser.parse_args()
    print("| size | instances | lines | crossings | least | most | fake | least | most | s to draw one |")
    print("| --- " * 10 + "|")
    for size in arguments.sizes:
        began = time.monotonic()
        streets = [make_instance(seed, LADDER[size]) for seed in range(arguments.count)]
        seconds = (time.monotonic() - began) / len(streets)
        lines = np.mean([len(street.graph.segments) for street in streets])
        crossings = np.array([len(street.graph.edges) for street in streets])
        fake = np.array([1 - street.real.mean() for street in streets])
        print(
            f"| {size} | {len(streets)} | {lines:.0f} | {crossings.mean():.0f} | {crossings.min()} | {crossings.max()} "
            f"| {fake.mean():.1%} | {fake.min():.1%} | {fake.max():.1%} | {seconds:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
