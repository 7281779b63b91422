"""How sure the place of each line is, fitted and measured: python tests/benchmarks/probability.py DATASET ...

DATASET is a folder that `linecad evaluate` knows and whose truth has depth; bodies are placed by the table of the
project. Three fits: how likely a seam holds, which it does where the true scales of both sides differ by less than
4.5 %; how likely the link of a body holds, where those of both pieces are as placed within 5 %; how likely a line is
right in its piece, from the lines that are right within 5 % by the scale of component 0 and the chance of their piece
by the two other fits. A fold is judged by the others: the photos of a real dataset, or a tenth of the made scenes. Real
and made photos weigh alike on the whole. What is named after `--unseen` is judged only. `--write` puts the fits to all
others into linecad/ties. With `--lines-alone` the seams and links of the project stay, and maps are not looked at.
"""

import argparse
import re
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import logistic
import numpy as np
from ties import WIDTHS, Placed, Table, placed
from ties_truth import Judged, judge

import linecad.ties.links
import linecad.ties.probability
import linecad.ties.seams
import linecad.ties.table
from linecad.arrays import Bool, Float, Int, Text
from linecad.evaluation.datasets import find_dataset
from linecad.geometry import lengths
from linecad.ties.links import Link, find_links
from linecad.ties.pieces import with_pieces_heard
from linecad.ties.probability import chances, line_features, main_lines
from linecad.ties.seams import Seam
from solver.robust import agreeing_with

RIGHT = 0.05
RIGHT_PART = {"seams": 0.045, "links": RIGHT}  # log ratio of the scales of both sides
RIDGE_OF_SEAMS, RIDGE_OF_LINKS, RIDGE = 10.0, 5.0, 30.0
SURE = 0.9
FOLDS = 10  # of made scenes
TABLE: Table = {"AT_ONCE": linecad.ties.table.AT_ONCE, "LOG_ODDS": linecad.ties.table.LOG_ODDS}


@dataclass(frozen=True, eq=False)
class Looked:
    """A photo with its bodies in their places, and what tells how sure these are."""

    photo: Judged
    dataset: str  # with what was heard
    fold: str
    seams: list[Seam]
    links: list[Link]
    length: Float  # (N,) of the lines of component 0, 0 for others
    features: Float  # (P, F) of lines, at the points that are judged
    piece: Int  # (P,) in which that line is
    right: Float  # (P,) 0 or 1
    log_scale: Float  # (B + 1,) of the bodies and the ground

    @property
    def errors_of_links(self) -> list[float]:
        """By how much the two pieces of each link stand wrong to each other, log scale."""
        off = self.log_scale[self.photo.pieces.body] - self.photo.true_pieces
        return [float(abs(off[link.piece] - off[link.other])) for link in self.links]


@dataclass(frozen=True, eq=False)
class Rows:
    """What is fitted: M seams or links of known truth, or points on lines."""

    features: Float  # (M, F)
    right: Float  # (M,) 0 or 1
    weight: Float  # (M,) real and made scenes weigh alike
    fold: Text  # (M,) names
    dataset: Text  # (M,) names
    is_unseen: Bool  # (M,)

    def others(self, fold: str) -> Bool:
        """The rows (M,) that judge a fold."""
        return np.asarray(~self.is_unseen & (self.fold != fold))

    def fit(self, chosen: Bool, ridge: float, held: Float | None = None) -> logistic.Logistic:
        held = None if held is None else held[chosen]
        return logistic.fit(self.features[chosen], self.right[chosen], ridge, self.weight[chosen], held=held)


def fold_of(photo: Judged) -> str:
    """The fold that a photo is judged in; its scene's name tells which tenth."""
    return f"made {sum(photo.scene.encode()) % FOLDS}" if photo.is_made else photo.dataset


def balanced(weight: Float, is_made: Bool) -> Float:
    """Weights (M,) with which real and made rows count alike, of mean 1."""
    for own in (is_made, ~is_made):
        weight = np.where(own, weight / max(weight[own].sum(), 1e-9), weight)
    balance: Float = weight / weight.mean()
    return balance


def look(photo: Judged, one: Placed, suffix: str) -> Looked | None:
    """None where no line of component 0 shows a point of known depth."""
    setting, places, pieces = photo.setting, one.places, photo.pieces
    margin = places.placement.margin
    seams = with_pieces_heard([seam for seam, _ in photo.seams], pieces, places.scale_with_ground)
    links = find_links(pieces, places.scale_with_ground, margin, places.evidence.reference, places.mapped)
    main = main_lines(setting, agreeing_with(setting.graph, places.log_depth))
    line = photo.on[photo.seen]
    error = places.log_depth[line] + photo.log_factor[photo.seen] - photo.log_true[photo.seen]
    if not main[line].any():
        return None
    right = np.abs(np.expm1(error - np.median(error[main[line]]))) < RIGHT
    features = np.column_stack(list(line_features(setting, places.log_depth, pieces).values()))
    return Looked(
        photo, photo.dataset + suffix, fold_of(photo), seams, links,
        lengths(np.diff(setting.graph.segments.ends, axis=1)[:, 0]) * main,
        features[line], pieces.piece[line], right.astype(np.float64), places.scale_with_ground,
    )  # fmt: skip


def rows_of(known: list[tuple[Looked, Float, Float, Float]], unseen: set[str]) -> Rows:
    """Rows of photos with features (M, F), right (M,) and weight (M,) of each."""
    known = [each for each in known if len(each[2])]
    count = [len(right) for _, _, right, _ in known]
    made = np.repeat([each.photo.is_made for each, *_ in known], count)
    return Rows(
        np.concatenate([features for _, features, _, _ in known]),
        np.concatenate([right for _, _, right, _ in known]),
        balanced(np.concatenate([weight for *_, weight in known]), made),
        np.repeat([each.fold for each, *_ in known], count),
        np.repeat([each.dataset for each, *_ in known], count),
        np.repeat([each.photo.dataset in unseen for each, *_ in known], count),
    )


def rows_of_parts(looked: list[Looked], parts: str, errors: list[list[float]], unseen: set[str]) -> Rows:
    """The "seams" or "links" of photos whose errors are known."""
    known = []
    for each, own in zip(looked, errors, strict=True):
        features_of = [part.features for part in (each.seams if parts == "seams" else each.links)]
        told = [number for number, error in enumerate(own) if np.isfinite(error)]
        features = np.array([list(features_of[number].values()) for number in told])
        known.append(
            (each, features, np.array([float(own[number] < RIGHT_PART[parts]) for number in told]), np.ones(len(told)))
        )
    return rows_of(known, unseen)


def print_parts(name: str, rows: Rows, ridge: float) -> dict[str, logistic.Logistic]:
    """Print how well seams or links are told apart; the fit that judges each fold."""
    fits = {fold: rows.fit(rows.others(fold), ridge) for fold in np.unique(rows.fold)}
    predicted = np.zeros(len(rows.right))
    for fold, fitted in fits.items():
        predicted[rows.fold == fold] = fitted.probability(rows.features[rows.fold == fold])
    print(f"\n| {name} | known | right | area under the curve | log loss | by tenths |\n" + "| --- " * 6 + "|")
    for dataset in dict.fromkeys(rows.dataset):
        own = rows.dataset == dataset
        right, p = rows.right[own], predicted[own]
        print(
            f"| {dataset} | {own.sum()} | {right.mean():.2f} | {logistic.area_under_curve(right, p):.3f} | "
            f"{logistic.log_loss(right, p):.3f} | {', '.join(filter(None, map(_cell, logistic.tenths(right, p))))} |",
            flush=True,
        )
    return fits


def _cell(tenth: tuple[float, float, int] | None) -> str:
    return "" if tenth is None else f"{tenth[0]:.2f} / {tenth[1]:.2f} ({tenth[2]})"


def chance_of(each: Looked, of_seams: logistic.Logistic, of_links: logistic.Logistic) -> Float:
    """(P,) that the piece of each point stands right, by fits."""

    class FittedSeam(Seam):
        @property
        def probability(self) -> float:
            return float(of_seams.probability(np.array([list(self.features.values())]))[0])

    class FittedLink(Link):
        @property
        def probability(self) -> float:
            return float(of_links.probability(np.array([list(self.features.values())]))[0])

    seams: list[Seam] = [FittedSeam(seam.larger, seam.smaller, seam.features) for seam in each.seams]
    links: list[Link] = [FittedLink(**vars(link)) for link in each.links]
    return chances(each.photo.pieces, seams, links, each.length)[each.piece]


def print_lines(rows: Rows, held: Float) -> None:
    """Print how far the probabilities hold."""
    predicted = np.zeros(len(rows.right))
    for fold in np.unique(rows.fold):
        own = rows.fold == fold
        fitted = rows.fit(rows.others(fold), RIDGE, held)
        predicted[own] = fitted.probability(rows.features[own]) * held[own]
    print(
        "\n| lines | "
        + " | ".join(f"{tenth / 10:.1f}" for tenth in range(10))
        + " | at 0.9: precision | recall | log loss |"
    )
    print("| --- " * 14 + "|")
    for name in dict.fromkeys(rows.dataset):
        own = rows.dataset == name
        right, weight, p = rows.right[own], rows.weight[own], predicted[own]
        cells = [_cell(tenth) for tenth in logistic.tenths(right, p, weight)]
        sure = p >= SURE
        share = (weight * right)[sure].sum() / (weight * right).sum()
        precision = np.average(right[sure], weights=weight[sure]) if sure.any() else np.nan
        loss = logistic.log_loss(right, p, weight)
        print(
            f"| {name} | " + " | ".join([*cells, f"{precision:.3f}", f"{share:.2f}", f"{loss:.3f}"]) + " |", flush=True
        )


def write(module: ModuleType, prefix: str, fitted: logistic.Logistic) -> None:
    """Put a fit into its module in place of the table there."""
    assert module.__file__ is not None
    path = Path(module.__file__)
    names = list(getattr(module, f"{prefix}LOG_ODDS"))
    slopes = "".join(f'    "{name}": {value:.4f},\n' for name, value in zip(names, fitted.slope.tolist(), strict=True))
    table = f"{prefix}AT_ONCE = {fitted.at_once:.4f}\n{prefix}LOG_ODDS: dict[str, float] = {{\n{slopes}}}\n"
    text = path.read_text(encoding="utf-8")
    text = re.sub(rf"^{prefix}AT_ONCE = .*?^}}\n", lambda _: table, text, count=1, flags=re.DOTALL | re.MULTILINE)
    path.write_text(text, encoding="utf-8")


def measure(
    by_photo: list[tuple[Judged, Placed]], by_map: list[tuple[Judged, Placed]], unseen: set[str], to_write: bool
) -> None:
    """Print all tables, and write the fits where that is asked for."""
    plain = [each for photo, one in by_photo if (each := look(photo, one, "")) is not None]
    seams = rows_of_parts(plain, "seams", [[error for _, error in each.photo.seams] for each in plain], unseen)
    of_seams = print_parts("seams", seams, RIDGE_OF_SEAMS)
    seams_to_all = seams.fit(~seams.is_unseen, RIDGE_OF_SEAMS)
    if to_write:
        write(linecad.ties.seams, "", seams_to_all)
    mapped = [each for photo, one in by_map if (each := look(photo, one, ", map")) is not None]
    for prefix, looked in (("", plain), ("WITH_MAP_", mapped)):
        if not looked:
            print("\nno depth map is heard", flush=True)
            continue
        links = rows_of_parts(looked, "links", [each.errors_of_links for each in looked], unseen)
        of_links = print_parts("links", links, RIDGE_OF_LINKS)
        to_all = links.fit(~links.is_unseen, RIDGE_OF_LINKS)
        if to_write:
            write(linecad.ties.links, prefix, to_all)
        held = [
            chance_of(each, of_seams.get(each.fold, seams_to_all), of_links.get(each.fold, to_all)) for each in looked
        ]
        measure_lines(looked, held, unseen, to_write and not prefix)


def measure_lines(looked: list[Looked], held: list[Float], unseen: set[str], to_write: bool) -> None:
    """Print how far the probabilities of lines hold, by the chances (P,) of their pieces, and write their fit."""
    rows = [(each, each.features, each.right, np.full(len(each.right), 1 / len(each.right))) for each in looked]
    lines, chance = rows_of(rows, unseen), np.concatenate(held)
    print_lines(lines, chance)
    if to_write:
        write(linecad.ties.probability, "", lines.fit(~lines.is_unseen, RIDGE, chance))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", type=Path)
    parser.add_argument("--unseen", nargs="*", type=Path, default=[], help="datasets that no fit sees")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--lines-alone", action="store_true", help="the third fit alone, without depth maps")
    parser.add_argument("--write", action="store_true", help="the fits into linecad/ties")
    chosen = parser.parse_args()
    with ProcessPoolExecutor(chosen.workers) as pool:
        jobs = [
            pool.submit(judge, folder.name, case)
            for folder in (*chosen.datasets, *chosen.unseen) for case in find_dataset(folder).cases
        ]  # fmt: skip
        photos = [photo for job in jobs if (photo := job.result()) is not None]
        print(f"{len(photos)} of {len(jobs)} photos", flush=True)
        plain = [pool.submit(placed, photo, (), TABLE) for photo in photos]
        # Of a real photo only points are known: a map made of these is no network's.
        made = [photo for photo in photos if photo.is_made and not chosen.lines_alone]
        mapped = [
            pool.submit(placed, photo, (), TABLE, (width, seed))
            for width in WIDTHS for seed, photo in enumerate(made)
        ]  # fmt: skip
        by_photo = list(zip(photos, [job.result() for job in plain], strict=True))
        by_map = list(zip(made * len(WIDTHS), [job.result() for job in mapped], strict=True))
    unseen = {folder.name for folder in chosen.unseen}
    if chosen.lines_alone:
        looked = [each for photo, one in by_photo if (each := look(photo, one, "")) is not None]
        held = [chances(each.photo.pieces, each.seams, each.links, each.length)[each.piece] for each in looked]
        measure_lines(looked, held, unseen, chosen.write)
    else:
        measure(by_photo, [one for one in by_map if one[1].heard], unseen, chosen.write)


if __name__ == "__main__":
    main()
