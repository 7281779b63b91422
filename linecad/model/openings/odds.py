"""Log-odds that a rectangle of a wall is an opening: by itself, and beside the others.

Each is a weighted sum of the evidence and a small network over it, which knows what goes with what. Fitted to the
rectangles of made scenes, an overlap of 0.72 (by itself) or 0.66 (beside the others) with a true opening counting as
one, below 0.6 or 0.53 as none: tests/benchmarks/openings.py. The weights are in odds.npz.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from linecad.arrays import Float

WEIGHTS = Path(__file__).with_name("odds.npz")
KINDS = ("first", "beside")
LEAST_LOG_ODDS = -0.3  # of an opening


@dataclass(frozen=True, eq=False)
class Network:
    """A weighted sum, and layers with rectified units between them, from evidence to log-odds."""

    names: tuple[str, ...]  # of the evidence (F,), in its order
    low: Float  # (F,) least evidence that it was fitted to; what is less counts as that
    high: Float  # (F,) most
    intercept: float
    slopes: Float  # (F,)
    layers: tuple[tuple[Float, Float], ...]  # weights (O, I) and biases (O,); of the last one O is 1

    def log_odds(self, evidence: Float) -> Float:
        """(N,) of evidence (N, F)."""
        within: Float = np.clip(evidence, self.low, self.high)
        found = within
        for weights, biases in self.layers[:-1]:
            found = np.maximum(found @ weights.T + biases, 0.0)
        weights, biases = self.layers[-1]
        return np.asarray(self.intercept + within @ self.slopes + (found @ weights.T + biases)[:, 0])


def log_odds_alone(evidence: Float) -> Float:
    """Log-odds (N,) by the evidence (N, F) of each rectangle alone."""
    return read_networks()[0].log_odds(evidence)


def log_odds_beside(evidence: Float, beside: Float) -> Float:
    """Log-odds (N,) by the evidence (N, F) of each rectangle and how it lies to the others (N, G)."""
    return read_networks()[1].log_odds(np.column_stack([evidence, beside]))


@cache
def read_networks(path: Path = WEIGHTS) -> tuple[Network, Network]:
    """By itself, in the order of `evidence.NAMES`; beside the others: these, then those of `neighbours.NAMES`."""
    with np.load(path) as kept:
        by_itself, beside = (_network(kept, kind) for kind in KINDS)
    return by_itself, beside


def _network(kept: Mapping[str, np.ndarray], kind: str) -> Network:
    def part(name: str) -> Float:
        return np.asarray(kept[f"{kind} {name}"], np.float64)

    return Network(
        tuple(kept[f"{kind} names"].tolist()),
        part("low"),
        part("high"),
        float(part("at once")),
        part("slopes"),
        tuple((part(f"weights {k}"), part(f"shifts {k}")) for k in range(int(kept[f"{kind} layers"]))),
    )


def write_networks(by_itself: Network, beside: Network, path: Path) -> None:
    """Keep two networks as `read_networks` reads them, in single precision."""
    kept: dict[str, np.ndarray] = {}
    for kind, network in zip(KINDS, (by_itself, beside), strict=True):
        kept |= {f"{kind} names": np.array(network.names), f"{kind} layers": np.array(len(network.layers))}
        parts = {"low": network.low, "high": network.high, "at once": network.intercept, "slopes": network.slopes}
        for k, (weights, biases) in enumerate(network.layers):
            parts |= {f"weights {k}": weights, f"shifts {k}": biases}
        kept |= {f"{kind} {name}": np.asarray(values, np.float32) for name, values in parts.items()}
    np.savez(path, allow_pickle=False, **kept)
