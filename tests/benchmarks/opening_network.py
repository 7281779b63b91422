"""The networks that tell openings among the rectangles of walls, and how they are trained; used by openings.py.

Needs torch.
"""

import logistic
import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from linecad.arrays import Float
from linecad.model.openings.odds import Network

UNITS = (96, 48)
BATCH, RATE, DECAY = 1024, 3e-3, 0.2
EPOCHS = 15
NOISE = 0.2  # of the spread of each number, added anew at each step: what made scenes tell to the last digit
SHARE = 0.7  # of the network in the log-odds, the rest is a logistic regression's: alone, it judges drawn walls badly
RIDGE = 1.0
LEAST_SPREAD = 1e-6
OUTERMOST = 0.05  # per cent of the rectangles at either side, beyond which a number counts as theirs


def train(names: tuple[str, ...], evidence: Float, right: Float, weight: Float, seed: int = 0) -> Network:
    """Sum and network fitted to whether rectangles (N,), each of a weight, are `right`: by evidence (N, F) of names."""
    torch.manual_seed(seed)
    torch.use_deterministic_algorithms(True)
    low, high = np.percentile(evidence, [OUTERMOST, 100 - OUTERMOST], axis=0)
    evidence = np.clip(evidence, low, high)
    middle, spread = evidence.mean(axis=0), evidence.std(axis=0) + LEAST_SPREAD
    rows = torch.tensor((evidence - middle) / spread, dtype=torch.float32)
    wanted, counts = (torch.tensor(each, dtype=torch.float32) for each in (right, weight))
    linear = [nn.Linear(a, b) for a, b in zip((rows.shape[1], *UNITS), (*UNITS, 1), strict=True)]
    network = nn.Sequential(linear[0], *(each for layer in linear[1:] for each in (nn.ReLU(), layer)))
    descent = torch.optim.AdamW(network.parameters(), lr=RATE, weight_decay=DECAY)
    pace = torch.optim.lr_scheduler.CosineAnnealingLR(descent, EPOCHS * -(-len(rows) // BATCH))
    for _ in range(EPOCHS):
        for own in torch.randperm(len(rows)).split(BATCH):
            descent.zero_grad()
            _loss(network(rows[own] + NOISE * torch.randn_like(rows[own])), wanted[own], counts[own]).backward()
            descent.step()
            pace.step()
    layers = [(_array(layer.weight), _array(layer.bias)) for layer in linear]
    # The first layer takes the evidence as it is.
    weights = layers[0][0] / spread
    layers[0] = weights, layers[0][1] - weights @ middle
    layers[-1] = SHARE * layers[-1][0], SHARE * layers[-1][1]
    plain = logistic.fit(evidence, right, RIDGE, weight)
    return Network(names, low, high, (1 - SHARE) * plain.at_once, (1 - SHARE) * plain.slope, tuple(layers))


def _loss(log_odds: Tensor, right: Tensor, weight: Tensor) -> Tensor:
    each = functional.binary_cross_entropy_with_logits(log_odds[:, 0], right, reduction="none")
    return (weight * each).mean()


def _array(values: Tensor) -> Float:
    return np.asarray(values.detach().numpy(), np.float64)
