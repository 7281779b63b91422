"""The network that finds the feet of walls: python tests/benchmarks/feet.py train | measure DATASET ...

DATASET is a folder of made scenes (`linecad dataset`). Each wall of a body of known scale is an example; those whose
foot is seen in a few columns only are left out. Where a ceiling is seen, the heads of walls are examples for training
too.

`train` fits the network to all examples and writes linecad/ties/foot.onnx; it needs PyTorch and ONNX. `measure` needs
neither, and prints how well the network of the project finds feet. Measure on scenes that it was not trained on.
"""

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

# What is trained goes into the checkout that this file is in, whichever linecad is installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from feet_truth import UNSEEN, Example, examples_of
from ties_truth import look_at, scene_of

from linecad.arrays import Bool, Float
from linecad.evaluation.datasets import Case, find_dataset
from linecad.ties.feet import NETWORK, foot_probabilities, peaks
from linecad.ties.walls import ROW, ROWS

NEEDED = {"torch": "PyTorch", "onnx": "ONNX"}
EPOCHS = 26
RIGHT = 0.04  # log height
LEAST_PROBABILITIES = (0.2, 0.35, 0.5, 0.65, 0.8, 0.9)


def examples_in(dataset: str, case: Case, with_heads: bool) -> list[Example]:
    """The clear examples of a photo; none where it has no bodies of known scale."""
    seen = look_at(case)
    if seen is None:
        return []
    assert seen.reference.truth is not None
    scene, truth = scene_of(dataset, case), seen.reference.truth
    examples = examples_of(scene, seen.setting, seen.true_scale, truth)
    heads = examples_of(scene, seen.setting, seen.true_scale, truth, is_above=True) if with_heads else []
    if any(head.is_clear and head.row != UNSEEN for head in heads):  # else no ceiling is seen
        examples += heads
    return [example for example in examples if example.is_clear]


def collect(folders: Sequence[Path], workers: int, with_heads: bool) -> dict[str, list[Example]]:
    """The clear examples of each dataset. Ends the program where a dataset is not of made scenes."""
    if len({folder.name for folder in folders}) < len(folders):
        raise SystemExit("two datasets have one name")
    cases = {folder.name: find_dataset(folder).cases for folder in folders}
    for name, of_dataset in cases.items():
        if any(case.kind != "made" for case in of_dataset):
            raise SystemExit(f"{name} is no dataset of made scenes; only these tell where walls meet the ground")
    with ProcessPoolExecutor(workers) as pool:
        jobs = {name: [pool.submit(examples_in, name, case, with_heads) for case in of] for name, of in cases.items()}
        return {name: [example for job in of for example in job.result()] for name, of in jobs.items()}


def rows_of(examples: Sequence[Example]) -> Float:
    """The rows (W,) of their feet, negative where these are not seen."""
    return np.array([example.row for example in examples])


@dataclass(frozen=True, eq=False)
class Read:
    """What the network says of W walls, and whether it is right."""

    is_visible: Bool  # (W,) the photo shows the foot
    probability: Float  # (W,) of the clearest foot, 0 where there is none
    error: Float  # (W,) log height of the clearest foot less that of the true one, NaN where one of them is not seen

    @property
    def is_right(self) -> Bool:
        right: Bool = np.abs(self.error) < RIGHT
        return right


def read(examples: Sequence[Example]) -> Read:
    """The examples as the network of the project reads them."""
    of_walls = foot_probabilities(np.stack([example.strip.layers for example in examples]))
    clearest = np.array([(peaks(rows[:ROWS]) or [(np.nan, 0.0)])[0] for rows in of_walls])
    row = rows_of(examples)
    return Read(row >= 0, clearest[:, 1], np.where(row >= 0, ROW * (clearest[:, 0] - row), np.nan))


def print_measured(of_datasets: dict[str, Read]) -> None:
    print("\n| dataset | walls | show their foot | most probable foot right | median error |")
    print("| --- | --- | --- | --- | --- |")
    for name, found in of_datasets.items():
        right, error = found.is_right[found.is_visible], found.error[found.is_right]
        middle = f"{100 * np.median(error):+.1f} %" if len(error) else ""
        print(f"| {name} | {len(found.error)} | {len(right)} | {_share(right)} | {middle} |")
    print("\n| dataset | probability at least | walls | right | of visible feet |\n| --- | --- | --- | --- | --- |")
    for name, found in of_datasets.items():
        for least in LEAST_PROBABILITIES:
            said = found.probability >= least
            right = found.is_right
            cells = f"{said.sum()} | {_share(right[said])} | {_share((said & right)[found.is_visible])}"
            print(f"| {name} | {least} | {cells} |", flush=True)


def _share(which: Bool) -> str:
    return f"{which.mean():.3f}" if len(which) else ""


def train_network(of_datasets: dict[str, list[Example]], epochs: int, seed: int) -> None:
    """Fit the network to all examples and write it into the project. Needs PyTorch and ONNX."""
    from foot_network import train, write_network

    examples = [example for of_dataset in of_datasets.values() for example in of_dataset]
    row = rows_of(examples)
    print(f"{len(examples)} walls, of which {(row >= 0).sum()} show their foot", flush=True)
    strips = np.stack([example.strip.layers for example in examples])
    write_network(train(strips, row, epochs, seed, lambda line: print(line, flush=True)), NETWORK)
    print(f"{NETWORK}: {NETWORK.stat().st_size} bytes")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for command in ("train", "measure"):
        own = commands.add_parser(command)
        own.add_argument("datasets", nargs="+", type=Path, metavar="DATASET")
        own.add_argument("--workers", type=int, default=2, help="processes")
        if command == "train":
            own.add_argument("--epochs", type=int, default=EPOCHS)
            own.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    missing = [name for module, name in NEEDED.items() if chosen.command == "train" and find_spec(module) is None]
    if missing:
        raise SystemExit(f"not installed: {', '.join(missing)}; training needs PyTorch and ONNX, measuring does not")
    of_datasets = collect(chosen.datasets, chosen.workers, with_heads=chosen.command == "train")
    empty = [name for name, examples in of_datasets.items() if not examples]
    if empty:
        raise SystemExit(f"no wall of known scale found in {', '.join(empty)}")
    if chosen.command == "train":
        train_network(of_datasets, chosen.epochs, chosen.seed)
    else:
        print_measured({name: read(examples) for name, examples in of_datasets.items()})


if __name__ == "__main__":
    main()
