"""Fit the weights of crossings to labelled photos: `PYTHONPATH=. python tests/benchmarks/fit_weights.py DATASET ...`.

A logistic regression of "real" on the features of cues/fitted.py, over all decided crossings of the line graphs
of all photos. Each photo is also judged by a fit to the photos of the other folds: the area under the curve and the
log-loss with the fitted table, with the table of junction kinds, and with the colours of linecad/evaluation/features.py
added. `--write` writes linecad/fitted_weights.json. Fit on photos that nothing else is measured on.
"""

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from linecad.arrays import Bool, Float, Int
from linecad.errors import LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.features import COLOUR_FEATURES, colour_features
from linecad.evaluation.labels import FAKE, REAL
from linecad.evaluation.methods import Settings
from linecad.evaluation.references import open_case
from linecad.finding import connect, find_lines
from linecad.graph.cues.fitted import (
    COLLINEAR_FEATURES,
    CROSSING_FEATURES,
    TABLE,
    collinear_features,
    crossing_features,
)

RIDGE = 10.0  # pull of the factors of standardised features towards zero, in crossings
STEPS = 100  # of Newton's method, halved while they do not help
CONVERGED = 1e-9  # of the loss
FOLDS = 5
LEAST_WEIGHT = 0.1
DIGITS = 4  # of the table


@dataclass(frozen=True, eq=False)
class Sample:
    """The decided crossings of one photo."""

    name: str
    crossing: Float  # (E, F) features; rows of collinear edges mean nothing
    collinear: Float  # (E, G)
    colours: Float  # (E, 3)
    is_collinear: Bool  # (E,)
    real: Bool  # (E,)
    weight: Float  # (E,) by junction kind


@dataclass(frozen=True, eq=False)
class Fit:
    """Log-odds of features as they are, not standardised."""

    constant: float
    factors: Float  # (F,)

    def odds(self, features: Float) -> Float:
        """Log-odds (N,) of features (N, F)."""
        odds: Float = self.constant + features @ self.factors
        return odds


def read_sample(case: Case) -> Sample | None:
    """The crossings of a photo with labels, None where there are none."""
    photo, reference = open_case(case)
    found = find_lines(photo)
    whole, _ = connect(found, Settings().whole_photo())
    label = reference.label(whole, found.camera, found.frame.rotation)
    decided = (label == REAL) | (label == FAKE)
    if not decided.any():
        return None
    return Sample(
        case.name,
        crossing_features(whole, photo.width)[decided],
        collinear_features(whole, photo.width)[decided],
        colour_features(photo.pixels, whole)[decided],
        (whole.kind == "collinear")[decided],
        (label == REAL)[decided],
        whole.weight[decided],
    )


def fit_logistic(features: Float, real: Bool) -> Fit:
    """Logistic regression by Newton's method on standardised features, with a ridge on all factors but the constant."""
    mean, spread = features.mean(axis=0), features.std(axis=0)
    spread = np.where(spread > 0, spread, 1.0)
    design = np.column_stack([np.ones(len(features)), (features - mean) / spread])
    ridge = np.full(design.shape[1], RIDGE)
    ridge[0] = 1e-6  # so that a sample without a fake stays finite
    beta = np.zeros(design.shape[1])

    def loss(at: Float) -> float:
        odds = design @ at
        return float(np.logaddexp(0, np.where(real, -odds, odds)).sum() + (ridge * at**2).sum() / 2)

    now = loss(beta)
    for _ in range(STEPS):
        chance = 1 / (1 + np.exp(-(design @ beta)))
        slope = design.T @ (chance - real) + ridge * beta
        curve = (design * (chance * (1 - chance))[:, None]).T @ design + np.diag(ridge)
        step = np.linalg.solve(curve, slope)
        size = 1.0
        while loss(beta - size * step) > now and size > CONVERGED:
            size /= 2
        beta = beta - size * step
        before, now = now, loss(beta)
        if before - now <= CONVERGED * abs(before):
            break
    factors = beta[1:] / spread
    return Fit(float(beta[0] - factors @ mean), factors)


def area_under_curve(score: Float, real: Bool) -> float:
    """Chance that a real crossing scores higher than a fake one, half for a tie."""
    order = np.argsort(score, kind="stable")
    _, inverse, count = np.unique(score[order], return_inverse=True, return_counts=True)
    rank = np.empty(len(score))
    rank[order] = (np.cumsum(count) - (count - 1) / 2)[inverse]
    wins = rank[real].sum() - real.sum() * (real.sum() + 1) / 2
    return float(wins / (real.sum() * (~real).sum()))


def log_loss(odds: Float, real: Bool) -> float:
    """Mean negative log of the chance that was given to what is true."""
    return float(np.logaddexp(0, np.where(real, -odds, odds)).mean())


def gathered(samples: list[Sample], name: str, collinear: bool) -> tuple[Float, Bool, Float, Int]:
    """Features, labels, weights by kind, and the number of the photo, of one kind of edge."""
    chosen = [sample.is_collinear == collinear for sample in samples]
    features = {
        "geometry": [sample.collinear if collinear else sample.crossing for sample in samples],
        "with colours": [np.column_stack([sample.crossing, sample.colours]) for sample in samples],
    }[name]
    return (
        np.concatenate([rows[own] for rows, own in zip(features, chosen, strict=True)]),
        np.concatenate([sample.real[own] for sample, own in zip(samples, chosen, strict=True)]),
        np.concatenate([sample.weight[own] for sample, own in zip(samples, chosen, strict=True)]),
        np.concatenate([np.full(own.sum(), number) for number, own in enumerate(chosen)]),
    )


def judge(samples: list[Sample], name: str, collinear: bool) -> None:
    """Print how well a fit to the other folds tells the crossings of each fold."""
    features, real, weight, photo = gathered(samples, name, collinear)
    odds = np.zeros(len(real))
    for fold in range(FOLDS):
        own = photo % FOLDS == fold
        if own.any() and not own.all():
            odds[own] = fit_logistic(features[~own], real[~own]).odds(features[own])
    what = "collinear" if collinear else "crossings"
    print(
        f"{what}, {name}: {len(real)} decided, {real.mean():.1%} real; area under the curve "
        f"{area_under_curve(odds, real):.3f} (by kind {area_under_curve(weight, real):.3f}), "
        f"log-loss {log_loss(odds, real):.3f} (a constant "
        f"{log_loss(np.full(len(real), np.log(real.mean() / (1 - real.mean()))), real):.3f})"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dataset", type=Path, nargs="+")
    parser.add_argument("--write", action="store_true", help=f"write linecad/{TABLE}")
    chosen = parser.parse_args()
    samples: list[Sample] = []
    for folder in chosen.dataset:
        for case in find_dataset(folder).cases:
            try:
                sample = read_sample(case)
            except LinecadError as error:
                print(f"{case.name}: {error}")
                continue
            if sample is not None:
                samples.append(sample)
                print(f"{case.name}: {len(sample.real)} decided crossings, {sample.real.mean():.1%} real", flush=True)
    for collinear, what in ((False, "crossings"), (True, "collinear edges")):
        real = gathered(samples, "geometry", collinear)[1] if samples else np.zeros(0, bool)
        if not (real.any() and not real.all()):
            parser.error(f"there are no {what} of both labels in these photos; give a dataset of our own")
    judge(samples, "geometry", False)
    judge(samples, "with colours", False)
    judge(samples, "geometry", True)
    tables = {}
    for key, names, collinear in (("crossing", CROSSING_FEATURES, False), ("collinear", COLLINEAR_FEATURES, True)):
        features, real, _, _ = gathered(samples, "geometry", collinear)
        fit = fit_logistic(features, real)
        tables[key] = {
            "constant": round(fit.constant, DIGITS),
            "factors": {name: round(float(factor), DIGITS) for name, factor in zip(names, fit.factors, strict=True)},
        }
        if not collinear:
            unit = round(max(float(np.median(fit.odds(features))), LEAST_WEIGHT), DIGITS)
    features, real, _, _ = gathered(samples, "with colours", False)
    factors = fit_logistic(features, real).factors.round(2).tolist()
    print("with colours:", dict(zip((*CROSSING_FEATURES, *COLOUR_FEATURES), factors, strict=True)))
    table = {
        "fitted to": f"{len(samples)} photos of {', '.join(folder.resolve().name for folder in chosen.dataset)}",
        "unit": unit, "least": LEAST_WEIGHT, **tables,
    }  # fmt: skip
    text = json.dumps(table, indent=1) + "\n"
    print(text, end="")
    if chosen.write:
        (Path(__file__).resolve().parents[2] / "linecad" / TABLE).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
