"""Strips of walls as other photos might show them: what the network of feet is trained on; used by foot_network.py."""

import numpy as np
from feet_truth import UNSEEN

from linecad.arrays import Float
from linecad.ties.walls import COLUMNS, ROWS, Strips

LAYERS = 6
WIDE = COLUMNS // 32  # columns for one of the 32 that widths below were chosen for
SHIFT = 30  # rows
BANDS = 0.4  # share of strips that change at rows which are no foot
BESIDE = 3  # rows beside a foot, where no band begins or ends
HEDGES = 0.2  # share of feet with one before them


def grain(shape: tuple[int, int], random: np.random.Generator) -> Float:
    """Noise (3, R, C) of several scales, mostly gray, as stone, grass and plaster have."""
    found = np.zeros((3, *shape))
    for scale in (1, 2, 4, 8):
        rows, columns = (-(-side // scale) for side in shape)
        gray = random.normal(0, random.uniform(0, 0.35), (1, rows, columns))
        tinted = gray + random.normal(0, random.uniform(0, 0.12), (3, rows, columns))
        found += np.kron(tinted, np.ones((1, scale, scale)))[:, : shape[0], : shape[1]]
    return found


def add_hedge(strip: Strips, foot: int, random: np.random.Generator) -> bool:
    """Draw a hedge over a foot, its own foot being lower; whether all of the foot is hidden."""
    hidden = min(ROWS, foot + int(random.integers(2, 16)))
    ragged = np.minimum(foot, hidden - random.integers(10, 60)) - 1
    ragged = ragged - np.abs(np.cumsum(random.normal(0, 2 / WIDE**0.5, COLUMNS))).astype(int)
    is_hedge = (np.arange(ROWS)[:, None] >= ragged) & (np.arange(ROWS)[:, None] < hidden)
    is_whole = random.random() < 0.75
    if not is_whole:
        first = int(random.integers(0, COLUMNS // 2))
        is_hedge[:, :first] = is_hedge[:, first + int(random.integers(COLUMNS // 4, COLUMNS // 2)) :] = False
    if random.random() < 0.6:  # green and dark, most often
        tone = np.array([-random.uniform(0, 1.5), -random.uniform(0, 1), random.uniform(0, 1)])[:, None, None]
    else:
        tone = random.normal(0, 0.8, (3, 1, 1))
    leaves = tone + random.uniform(1, 3) * grain((ROWS, COLUMNS), random)
    leaves[0] -= random.uniform(0, 1.5) * np.clip(1 - (hidden - np.arange(ROWS)) / 40, 0, 1)[:, None]
    strip[:3] = np.where(is_hedge, leaves, strip[:3])
    strip[4][is_hedge] = 0
    return is_whole


def changed_example(strip: Strips, row: float, random: np.random.Generator) -> tuple[Strips, float]:
    """A strip (LAYERS, ROWS, COLUMNS) as another photo might show it, and its row: other light, ground and things."""
    strip = strip[:, :, ::-1].copy() if random.random() < 0.5 else strip.copy()
    if random.random() < 0.5:  # a part of the wall
        first = int(random.integers(0, 12 * WIDE))
        last = int(random.integers(max(first + 12 * WIDE, 20 * WIDE), COLUMNS + 1))
        strip = strip[:, :, np.linspace(first, last - 1, COLUMNS).round().astype(np.int64)]
    change_ground(strip[:3], row, random)
    if row >= 0 and random.random() < HEDGES and add_hedge(strip, round(row), random):
        row = UNSEEN
    change_light(strip[:3], random)
    strip[:3] *= strip[3]
    by = int(random.integers(-SHIFT, SHIFT + 1))
    if row >= 0 and not 4 < row + by < ROWS - 4:
        by = 0
    moved = np.zeros_like(strip)
    moved[:, max(0, by) : ROWS + min(0, by)] = strip[:, max(0, -by) : ROWS - max(0, by)]
    return moved, row + by if row >= 0 else row


def change_ground(colour: Strips, row: float, random: np.random.Generator) -> None:
    """Other ground, seldom, and a band that is no foot: if each foot were changed, a change would tell a foot."""
    if row >= 0:
        foot = round(row)
        if random.random() < 0.2:
            colour[:, foot:] += random.normal(0, 0.5, (3, 1, 1))
        if random.random() < 0.25:
            colour[:, foot:] += grain((ROWS - foot, COLUMNS), random)
        if random.random() < 0.3:
            colour[:, :foot] += grain((foot, COLUMNS), random)
    elif random.random() < 0.3:
        colour += grain((ROWS, COLUMNS), random)
    if random.random() < BANDS:  # kerbs, shadows and courses
        first = int(random.integers(0, ROWS - 2))
        last = int(random.integers(first + 2, ROWS + 1)) if random.random() < 0.5 else ROWS
        if row < 0 or min(abs(first - row), abs(last - row)) > BESIDE:
            colour[:, first:last] += random.normal(0, 0.4, (3, 1, 1))
            if random.random() < 0.4:
                colour[:, first:last] += grain((last - first, COLUMNS), random)


def change_light(colour: Strips, random: np.random.Generator) -> None:
    """Other light, noise, and something that stands before the wall."""
    if random.random() < 0.25:
        colour[1:] = 0
    if random.random() < 0.25:  # light that changes down the wall
        above, below = random.normal(0, 0.6, 2).tolist()
        colour[:1] += np.linspace(above, below, ROWS)[:, None]
    colour *= random.uniform(0.6, 1.5, (3, 1, 1))
    colour += random.normal(0, 0.25, (3, 1, 1))
    if random.random() < 0.35:
        colour += random.normal(0, random.uniform(0.02, 0.15), colour.shape)
    if random.random() < 0.3:
        left, top = random.integers(0, COLUMNS - 4 * WIDE), random.integers(0, ROWS - 10)
        width, height = random.integers(3 * WIDE, 11 * WIDE), random.integers(8, 90)
        colour[:, top : top + height, left : left + width] = random.normal(0, 1, (3, 1, 1))
