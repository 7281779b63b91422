"""How sure the place of each line is, fitted and measured: python tests/benchmarks/probability.py DATASET ...

DATASET is a folder that `linecad evaluate` knows and whose truth has depth; bodies are placed by the table of the
project. First the seams: how likely a weak cut through a body holds, which it does where the true scales of both sides
differ by less than 4.5 %. Then lines: that the depth of one is right within 5 %, by the scale of the reference body, is
the probability that its body stands where it should, times that no seam on the way fails. A fold is judged by the
others: the photos of a real dataset, or a tenth of the made scenes. Real and made photos weigh alike on the whole. What
is named after `--unseen` is judged only. `--write` puts the fits to all others into linecad/ties.
"""

import argparse
import re
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import logistic
import numpy as np
from ties import WIDTHS, Placed, placed
from ties_truth import Judged, judge

import linecad.ties.probability
import linecad.ties.seams
import linecad.ties.table
from linecad.arrays import Bool, Float
from linecad.evaluation.datasets import find_dataset
from linecad.ties.seams import Seam, hold

RIGHT_SEAM = 0.045  # log ratio of scales, so that both sides are right within 5 %
RIDGE_OF_SEAMS, RIDGE = 50.0, 30.0
SURE = 0.9
FOLDS = 10  # of made scenes
TABLE = {"AT_ONCE": linecad.ties.table.AT_ONCE, "LOG_ODDS": linecad.ties.table.LOG_ODDS}


@dataclass(frozen=True, eq=False)
class Rows:
    """What is fitted: M seams of known truth, or points on lines."""

    features: Float  # (M, F)
    right: Float  # (M,) 0 or 1
    weight: Float  # (M,) real and made scenes weigh alike
    fold: np.ndarray  # (M,) names
    is_unseen: Bool  # (M,)

    def others(self, fold: str) -> Bool:
        """The rows (M,) that judge a fold."""
        return ~self.is_unseen & (self.fold != fold)


def fold_of(photo: Judged) -> str:
    """The fold that a photo is judged in; its scene's name tells which tenth."""
    return f"made {sum(photo.scene.encode()) % FOLDS}" if photo.is_made else photo.dataset


def balanced(weight: Float, is_made: Bool) -> Float:
    """Weights (M,) with which real and made rows count alike, of mean 1."""
    for own in (is_made, ~is_made):
        weight = np.where(own, weight / max(weight[own].sum(), 1e-9), weight)
    balance: Float = weight / weight.mean()
    return balance


def rows_of_seams(photos: list[Judged], unseen: set[str]) -> Rows:
    known = [(seam, error, photo) for photo in photos for seam, error in photo.seams if np.isfinite(error)]
    return Rows(
        np.array([list(seam.features.values()) for seam, _, _ in known]),
        np.array([float(error < RIGHT_SEAM) for _, error, _ in known]),
        balanced(np.ones(len(known)), np.array([photo.is_made for _, _, photo in known])),
        np.array([fold_of(photo) for _, _, photo in known]),
        np.array([photo.dataset in unseen for _, _, photo in known]),
    )


def fit_seams(rows: Rows, chosen: Bool) -> logistic.Logistic:
    return logistic.fit(rows.features[chosen], rows.right[chosen], RIDGE_OF_SEAMS, rows.weight[chosen])


def held_of(photo: Judged, fitted: logistic.Logistic) -> Float:
    """(N,) that no seam parts a line from the main part of its body, by a fit."""

    class Fitted(Seam):
        @property
        def probability(self) -> float:
            return float(fitted.probability(np.array([list(self.features.values())]))[0])

    return hold(
        len(photo.setting.log_depth), [Fitted(seam.larger, seam.smaller, seam.features) for seam, _ in photo.seams]
    )


def print_seams(rows: Rows, dataset: np.ndarray) -> None:
    predicted = np.zeros(len(rows.right))
    for fold in np.unique(rows.fold):
        own = rows.fold == fold
        predicted[own] = fit_seams(rows, rows.others(fold)).probability(rows.features[own])
    print("\n| seams | known | right | area under the curve | log loss | by tenths |\n" + "| --- " * 6 + "|")
    for name in dict.fromkeys(dataset):
        own = dataset == name
        right, p = rows.right[own], predicted[own]
        print(
            f"| {name} | {own.sum()} | {right.mean():.2f} | {logistic.area_under_curve(right, p):.3f} | "
            f"{logistic.log_loss(right, p):.3f} | {', '.join(filter(None, map(_cell, logistic.tenths(right, p))))} |",
            flush=True,
        )


def _cell(tenth: tuple[float, float, int] | None) -> str:
    return "" if tenth is None else f"{tenth[0]:.2f} / {tenth[1]:.2f} ({tenth[2]})"


def rows_of_lines(known: list[tuple[Judged, Placed]], unseen: set[str]) -> Rows:
    count = [len(one.right) for _, one in known]
    made = np.repeat([photo.is_made for photo, _ in known], count)
    return Rows(
        np.concatenate([one.features for _, one in known]),
        np.concatenate([one.right for _, one in known]),
        balanced(np.concatenate([np.full(many, 1 / many) for many in count]), made),
        np.repeat([fold_of(photo) for photo, _ in known], count),
        np.repeat([photo.dataset in unseen for photo, _ in known], count),
    )


def print_lines(rows: Rows, held: Float, dataset: np.ndarray) -> logistic.Logistic:
    """Print how far the probabilities hold; the fit to all that is not unseen."""
    predicted = np.zeros(len(rows.right))
    for fold in np.unique(rows.fold):
        own, others = rows.fold == fold, rows.others(fold)
        fitted = _fit_lines(rows, held, others)
        predicted[own] = fitted.probability(rows.features[own]) * held[own]
    print("\n| lines | " + " | ".join(f"{tenth / 10:.1f}" for tenth in range(10)) + " | at 0.9: precision | recall |")
    print("| --- " * 13 + "|")
    for name in dict.fromkeys(dataset):
        own = dataset == name
        right, weight, p = rows.right[own], rows.weight[own], predicted[own]
        cells = [_cell(tenth) for tenth in logistic.tenths(right, p, weight)]
        sure = p >= SURE
        share = (weight * right)[sure].sum() / (weight * right).sum()
        precision = np.average(right[sure], weights=weight[sure]) if sure.any() else np.nan
        print(f"| {name} | " + " | ".join([*cells, f"{precision:.3f}", f"{share:.2f}"]) + " |", flush=True)
    return _fit_lines(rows, held, ~rows.is_unseen)


def _fit_lines(rows: Rows, held: Float, chosen: Bool) -> logistic.Logistic:
    return logistic.fit(rows.features[chosen], rows.right[chosen], RIDGE, rows.weight[chosen], held=held[chosen])


def _write(path: Path, prefix: str, names: list[str], fitted: logistic.Logistic) -> None:
    slopes = "".join(f'    "{name}": {value:.4f},\n' for name, value in zip(names, fitted.slope.tolist(), strict=True))
    table = f"{prefix}AT_ONCE = {fitted.at_once:.4f}\n{prefix}LOG_ODDS: dict[str, float] = {{\n{slopes}}}\n"
    text = path.read_text(encoding="utf-8")
    text = re.sub(rf"^{prefix}AT_ONCE = .*?^}}\n", lambda _: table, text, count=1, flags=re.DOTALL | re.MULTILINE)
    path.write_text(text, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--unseen", nargs="*", type=Path, default=[], help="datasets that no fit sees")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--write", action="store_true", help="the fits into linecad/ties")
    chosen = parser.parse_args()
    unseen = {folder.name for folder in chosen.unseen}
    with ProcessPoolExecutor(chosen.workers) as pool:
        jobs = [
            pool.submit(judge, folder.name, case)
            for folder in (*chosen.datasets, *chosen.unseen) for case in find_dataset(folder).cases
        ]  # fmt: skip
        photos = [photo for job in jobs if (photo := job.result()) is not None]
        print(f"{len(photos)} of {len(jobs)} photos", flush=True)
        plain = [pool.submit(placed, photo, (), TABLE) for photo in photos]
        mapped = [
            pool.submit(placed, photo, (), TABLE, (width, seed))
            for width in WIDTHS for seed, photo in enumerate(photos)
        ]  # fmt: skip
        by_photo = list(zip(photos, [job.result() for job in plain], strict=True))
        by_map = list(zip(photos * len(WIDTHS), [job.result() for job in mapped], strict=True))
    seams = rows_of_seams(photos, unseen)
    print_seams(seams, np.array([photo.dataset for photo in photos for _, error in photo.seams if np.isfinite(error)]))
    by_fold = {fold: fit_seams(seams, seams.others(fold)) for fold in {fold_of(photo) for photo in photos}}
    held = {
        id(photo): held_of(photo, by_fold[fold_of(photo)]) for photo in photos
    }  # fmt: skip
    path = Path(linecad.ties.probability.__file__)
    if chosen.write:
        names = list(photos[0].seams[0][0].features)
        _write(Path(linecad.ties.seams.__file__), "", names, fit_seams(seams, ~seams.is_unseen))
    for suffix, prefix, known in (("", "", by_photo), (", map", "WITH_MAP_", [one for one in by_map if one[1].heard])):
        known = [one for one in known if len(one[1].right)]
        fitted = print_lines(
            rows_of_lines(known, unseen),
            np.concatenate([held[id(photo)][one.line] for photo, one in known]),
            np.concatenate([np.full(len(one.right), photo.dataset + suffix) for photo, one in known]),
        )
        if chosen.write:
            names = list(getattr(linecad.ties.probability, f"{prefix}LOG_ODDS"))
            _write(path, prefix, names, fitted)


if __name__ == "__main__":
    main()
