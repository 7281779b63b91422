"""The network that finds the feet of walls, and how it is trained; used by feet.py. Needs torch and onnx."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import torch
from feet_truth import UNSEEN
from torch import Tensor, nn
from torch.nn import functional

from linecad.arrays import Float
from linecad.ties.walls import COLUMNS, ROWS, Strips

LAYERS = 6
SHIFT = 30  # rows
BATCH, RATE, DECAY = 24, 4e-3, 1e-3
BLURRED = 0.75  # rows: how far from the foot a row still counts


def _block(
    inputs: int, outputs: int, kernel: tuple[int, int], apart: tuple[int, int] = (1, 1), step: int = 1
) -> nn.Module:
    padding = (apart[0] * (kernel[0] // 2), apart[1] * (kernel[1] // 2))
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, kernel, stride=(1, step), padding=padding, dilation=apart, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(),
    )


class FootNetwork(nn.Module):
    """From strips (W, LAYERS, ROWS, COLUMNS) to log-odds (W, ROWS + 1): each row, and that no foot is seen.

    Columns are looked at in pairs of twos, then all at once; rows from nearer to farther away.
    """

    def __init__(self) -> None:
        super().__init__()
        self.in_the_photo = nn.Sequential(
            _block(LAYERS, 24, (3, 3)),
            _block(24, 32, (3, 3), step=2),
            _block(32, 32, (3, 3), (2, 1)),
            _block(32, 48, (3, 3), (4, 1), 2),
        )
        self.mean, self.most = nn.AvgPool2d((1, COLUMNS // 4)), nn.MaxPool2d((1, COLUMNS // 4))
        self.near, self.far, self.farther = (
            _block(96, 64, (5, 1)),
            _block(64, 64, (5, 1), (3, 1)),
            _block(64, 64, (5, 1), (9, 1)),
        )
        self.row = nn.Conv2d(64, 1, 1)
        self.mean_row, self.most_row = nn.AvgPool2d((ROWS, 1)), nn.MaxPool2d((ROWS, 1))
        self.unseen = nn.Conv2d(128, 1, 1)
        self.drop = nn.Dropout(0.15)

    def forward(self, strips: Tensor) -> Tensor:
        """The log-odds, up to one constant a wall."""
        seen = self.in_the_photo(strips)
        rows = self.near(torch.cat([self.mean(seen), self.most(seen)], 1))
        rows = rows + self.far(self.drop(rows))
        rows = rows + self.farther(rows)
        unseen = self.unseen(torch.cat([self.mean_row(rows), self.most_row(rows)], 1))
        return torch.cat([self.row(rows), unseen], 2).flatten(1)


def train(strips: Strips, row: Float, epochs: int, seed: int = 0, report: Callable[[str], None] = print) -> FootNetwork:
    """The network fitted to strips (W, LAYERS, ROWS, COLUMNS) with their feet in rows (W,), negative where unseen."""
    torch.manual_seed(seed)
    torch.use_deterministic_algorithms(True)
    random = np.random.default_rng(seed)
    network = FootNetwork()
    steps = -(-len(strips) // BATCH)
    descent = torch.optim.AdamW(network.parameters(), lr=RATE, weight_decay=DECAY)
    pace = torch.optim.lr_scheduler.OneCycleLR(descent, RATE, total_steps=epochs * steps)
    for epoch in range(epochs):
        network.train()
        total = 0.0
        for images, feet in _batches(strips, row, random):
            descent.zero_grad()
            loss = _loss(network(images), feet)
            loss.backward()
            descent.step()
            pace.step()
            total += loss.item() * len(feet)
        report(f"epoch {epoch + 1} of {epochs}: loss {total / len(strips):.3f}")
    network.eval()
    return network


def write_network(network: FootNetwork, path: Path) -> None:
    """As ONNX, which OpenCV reads."""
    example = torch.zeros(1, LAYERS, ROWS, COLUMNS)
    torch.onnx.export(
        network, (example,), str(path), dynamo=False, opset_version=13, input_names=["strips"],
        output_names=["log_odds"], dynamic_axes={"strips": {0: "walls"}, "log_odds": {0: "walls"}},
    )  # fmt: skip


def _loss(log_odds: Tensor, feet: Tensor) -> Tensor:
    log_share = functional.log_softmax(log_odds, 1)
    near = torch.exp(-0.5 * ((torch.arange(ROWS)[None] - feet[:, None]) / BLURRED) ** 2)
    near = near / near.sum(1, keepdim=True).clamp_min(1e-9)
    return torch.where(feet >= 0, -(near * log_share[:, :ROWS]).sum(1), -log_share[:, ROWS]).mean()


def _batches(strips: Strips, row: Float, random: np.random.Generator) -> Iterator[tuple[Tensor, Tensor]]:
    order = random.permutation(len(strips))
    for start in range(0, len(order), BATCH):
        changed = [changed_example(strips[one], float(row[one]), random) for one in order[start : start + BATCH]]
        images, feet = zip(*changed, strict=True)
        yield torch.from_numpy(np.stack(images)).float(), torch.tensor(feet, dtype=torch.float32)


def grain(shape: tuple[int, int], random: np.random.Generator) -> Float:
    """Noise (3, R, C) of several scales, mostly gray, as stone, grass and plaster have."""
    found = np.zeros((3, *shape))
    for scale in (1, 2, 4, 8):
        rows, columns = (-(-side // scale) for side in shape)
        gray = random.normal(0, random.uniform(0, 0.35), (1, rows, columns))
        tinted = gray + random.normal(0, random.uniform(0, 0.12), (3, rows, columns))
        found += np.kron(tinted, np.ones((1, scale, scale)))[:, : shape[0], : shape[1]]
    return found


def changed_example(strip: Strips, row: float, random: np.random.Generator) -> tuple[Strips, float]:
    """A strip (LAYERS, ROWS, COLUMNS) as another photo might show it, and its row: other light, ground and things."""
    strip = strip[:, :, ::-1].copy() if random.random() < 0.5 else strip.copy()
    if random.random() < 0.5:  # a part of the wall
        first = int(random.integers(0, 12))
        last = int(random.integers(max(first + 12, 20), COLUMNS + 1))
        strip = strip[:, :, np.linspace(first, last - 1, COLUMNS).round().astype(np.int64)]
    colour = strip[:3]
    if row >= 0:
        foot = round(row)
        if random.random() < 0.45:
            colour[:, foot:] += random.normal(0, 0.5, (3, 1, 1))
        if random.random() < 0.5:
            colour[:, foot:] += grain((ROWS - foot, COLUMNS), random)
        if random.random() < 0.3:
            colour[:, :foot] += grain((foot, COLUMNS), random)
    elif random.random() < 0.3:
        colour += grain((ROWS, COLUMNS), random)
    if row >= 0 and random.random() < 0.15:  # a hedge hides the foot and seems to have one
        hidden = min(ROWS - 8, foot + int(random.integers(3, 15)))
        ragged = hidden - random.integers(10, 60) - np.abs(np.cumsum(random.normal(0, 2, COLUMNS))).astype(np.int64)
        is_hedge = (np.arange(ROWS)[:, None] >= ragged) & (np.arange(ROWS)[:, None] < hidden)
        leaves = random.normal(0, 0.8, (3, 1, 1)) + 2 * grain((ROWS, COLUMNS), random)
        colour[:] = np.where(is_hedge, leaves, colour)
        strip[4][is_hedge] = 0
        row = UNSEEN
    if random.random() < 0.25:
        colour[1:] = 0
    if random.random() < 0.25:  # light that changes down the wall
        above, below = random.normal(0, 0.6, 2).tolist()
        colour[:1] += np.linspace(above, below, ROWS)[:, None]
    colour *= random.uniform(0.6, 1.5, (3, 1, 1))
    colour += random.normal(0, 0.25, (3, 1, 1))
    if random.random() < 0.35:
        colour += random.normal(0, random.uniform(0.02, 0.15), colour.shape)
    if random.random() < 0.3:  # something stands before it
        left, top = random.integers(0, COLUMNS - 4), random.integers(0, ROWS - 10)
        width, height = random.integers(3, 11), random.integers(8, 90)
        colour[:, top : top + height, left : left + width] = random.normal(0, 1, (3, 1, 1))
    colour *= strip[3]
    by = int(random.integers(-SHIFT, SHIFT + 1))
    if row >= 0 and not 4 < row + by < ROWS - 4:
        by = 0
    moved = np.zeros_like(strip)
    moved[:, max(0, by) : ROWS + min(0, by)] = strip[:, max(0, -by) : ROWS - max(0, by)]
    return moved, row + by if row >= 0 else row
