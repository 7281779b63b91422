"""The network that finds the feet of walls, and how it is trained; used by feet.py. Needs torch and onnx."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import torch
from strip_changes import LAYERS, changed_example
from torch import Tensor, nn
from torch.nn import functional

from linecad.arrays import Float
from linecad.ties.walls import COLUMNS, ROWS, Strips

BATCH, RATE, DECAY = 24, 4e-3, 1e-2
DROPPED = 0.2  # share of what is seen of a strip as a whole that each step of the training does without
BLURRED = 0.75  # rows: how far from the foot a row still counts


def _block(
    inputs: int, outputs: int, kernel: tuple[int, int] = (3, 3), apart: int = 1, step: tuple[int, int] = (1, 1)
) -> nn.Module:
    """Kernel and step are of rows and columns; the rows that it looks at lie so far `apart`."""
    padding = (apart * (kernel[0] // 2), kernel[1] // 2)
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, kernel, stride=step, padding=padding, dilation=(apart, 1), bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(),
    )


class _Added(nn.Module):
    """What two blocks find, added to what they are given."""

    def __init__(self, layers: int) -> None:
        super().__init__()
        self.blocks = nn.Sequential(_block(layers, layers), _block(layers, layers))

    def forward(self, seen: Tensor) -> Tensor:
        return seen + self.blocks(seen)


class FootNetwork(nn.Module):
    """From strips (W, LAYERS, ROWS, COLUMNS) to log-odds (W, ROWS + 1): each row, and that no foot is seen.

    A strip is looked at ever coarser, until an eighth of the rows show it as a whole, and then ever finer again, with
    what was seen on the way down: what is foot and what is kerb or sill is told by all that stands above and below.
    """

    def __init__(self) -> None:
        super().__init__()
        self.fine = nn.Sequential(
            _block(LAYERS, 16, step=(1, 2)), _block(16, 24, step=(1, 2)), _block(24, 24)
        )  # all rows, a quarter of the columns
        self.coarse = nn.Sequential(_block(24, 32, step=(2, 1)), _block(32, 32))
        self.coarser = nn.Sequential(_block(32, 40, step=(2, 2)), _Added(40))
        self.coarsest = nn.Sequential(_block(40, 40, step=(2, 1)), _Added(40))
        self.whole = nn.Sequential(_block(80, 40, (5, 1)), _block(40, 40, (5, 1), 2))
        self.again = nn.ModuleList([_block(40 + 40, 32), _block(32 + 32, 32), _block(32 + 24, 32)])
        self.halved, self.twice = nn.AvgPool2d((1, 2)), nn.Upsample(scale_factor=(2, 1), mode="nearest")
        self.eightfold = nn.Upsample(scale_factor=(8, 1), mode="nearest")
        self.mean, self.most = nn.AvgPool2d((1, COLUMNS // 8)), nn.MaxPool2d((1, COLUMNS // 8))
        self.near, self.far, self.farther = (
            _block(64 + 40, 48, (5, 1)),
            _block(48, 48, (5, 1), 3),
            _block(48, 48, (5, 1), 9),
        )
        self.row = nn.Conv2d(48, 1, 1)
        self.mean_row, self.most_row = nn.AvgPool2d((ROWS // 8, 1)), nn.MaxPool2d((ROWS // 8, 1))
        self.unseen = nn.Conv2d(80, 1, 1)
        self.drop = nn.Dropout(DROPPED)

    def forward(self, strips: Tensor) -> Tensor:
        """The log-odds, up to one constant a wall."""
        fine = self.fine(strips)
        coarse = self.coarse(fine)
        coarser = self.coarser(coarse)
        coarsest = self.coarsest(coarser)
        whole = self.whole(self.drop(self._across(coarsest)))
        seen = self.again[0](torch.cat([self.twice(coarsest + whole), coarser], 1))
        seen = self.again[1](torch.cat([self.twice(seen), self.halved(coarse)], 1))
        seen = self.again[2](torch.cat([self.twice(seen), self.halved(fine)], 1))
        rows = self.near(self.drop(torch.cat([self._across(seen), self.eightfold(whole)], 1)))
        rows = rows + self.far(self.drop(rows))
        rows = rows + self.farther(rows)
        unseen = self.unseen(torch.cat([self.mean_row(whole), self.most_row(whole)], 1))
        return torch.cat([self.row(rows), unseen], 2).flatten(1)

    def _across(self, seen: Tensor) -> Tensor:
        """Mean and most of all columns."""
        return torch.cat([self.mean(seen), self.most(seen)], 1)


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
            with torch.autocast("cpu", dtype=torch.bfloat16):
                log_odds = network(images)
            loss = _loss(log_odds.float(), feet)
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
