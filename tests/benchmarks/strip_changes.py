"""Strips of walls as other photos might show them: what the network of feet is trained on; used by foot_network.py.

Made scenes are cleaner than photos, whose pavements have more edges than walls have feet, whose walls are longer, and
which have fewer pixels. A network that was trained on strips as they are finds four of five feet of made scenes and one
of six of photos.
"""

from collections.abc import Callable

import numpy as np
from feet_truth import UNSEEN

from linecad.arrays import Float
from linecad.ties.walls import COLUMNS, ROWS, Strips

LAYERS = 6
MUCH = 0.5  # share of strips that are changed much
WIDE = COLUMNS // 32  # columns for one of the 32 that widths below were chosen for
SHIFT = 30  # rows
BESIDE = 3  # rows beside a foot, where no band begins or ends
BANDS, MORE_BANDS = 0.4, 0.6  # share of strips that change at rows which are no foot
JOINTS = 0.25  # share of strips with a dark line along the foot, and of those with one somewhere
NEAR_FOOT = 20  # rows
FLIPPED = 0.25  # share of strips whose light, or one of whose tints, is the other way round
HEDGES = 0.2  # share of feet with one before them

Grain = Callable[[tuple[int, int], np.random.Generator], Float]


def grain(shape: tuple[int, int], random: np.random.Generator) -> Float:
    """Noise (3, R, C) of several scales, mostly gray, as stone, grass and plaster have."""
    found = np.zeros((3, *shape))
    for scale in (1, 2, 4, 8):
        rows, columns = (-(-side // scale) for side in shape)
        gray = random.normal(0, random.uniform(0, 0.35), (1, rows, columns))
        tinted = gray + random.normal(0, random.uniform(0, 0.12), (3, rows, columns))
        found += np.kron(tinted, np.ones((1, scale, scale)))[:, : shape[0], : shape[1]]
    return found


def faint_grain(shape: tuple[int, int], random: np.random.Generator) -> Float:
    return random.uniform(0.1, 1) * grain(shape, random)


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


def change_sides(colour: Strips, foot: int, random: np.random.Generator, grained: Grain) -> None:
    """Another ground, seldom: a change that each foot brings would tell the network where feet are."""
    if random.random() < 0.2:
        colour[:, foot:] += random.normal(0, 0.5, (3, 1, 1))
    if random.random() < 0.25:
        colour[:, foot:] += grained((ROWS - foot, COLUMNS), random)
    if random.random() < 0.3:
        colour[:, :foot] += grained((foot, COLUMNS), random)


def change_foot(colour: Strips, seen: Strips, foot: int, random: np.random.Generator) -> None:
    """Make a foot look as old walls' do: ground as light as the wall, a plinth, dirt, grain of either side."""
    if random.random() < 0.3:
        above, below = seen[max(0, foot - NEAR_FOOT) : foot], seen[foot : foot + NEAR_FOOT]
        if above.any() and below.any():
            wall = colour[:, max(0, foot - NEAR_FOOT) : foot][:, above > 0].mean(axis=1)
            ground = colour[:, foot : foot + NEAR_FOOT][:, below > 0].mean(axis=1)
            colour[:, foot:] += random.uniform(0.4, 1) * (wall - ground)[:, None, None]
    change_sides(colour, foot, random, faint_grain)
    if random.random() < 0.25:  # a plinth
        first = max(0, foot - int(random.integers(4, 45)))
        colour[:, first:foot] += random.normal(0, 0.5, (3, 1, 1))
        if random.random() < 0.5:
            colour[:, first:foot] += faint_grain((foot - first, COLUMNS), random)
    if random.random() < 0.25:  # splashed dirt, on the wall or before it
        first, last = max(0, foot - int(random.integers(3, 30))), min(ROWS, foot + int(random.integers(0, 10)))
        dirt = random.uniform(0.2, 1) * np.linspace(0, 1, last - first)[:, None] * random.uniform(0.4, 1, COLUMNS)
        colour[0, first:last] -= dirt


def add_joint(colour: Strips, row: int, random: np.random.Generator) -> None:
    """A dark line in a row, as moss in the corner of wall and ground draws one, or a course."""
    last = row + int(random.integers(1, 4))
    shade = random.uniform(0.3, 1.5) * random.uniform(0.3, 1, COLUMNS)
    colour[0, max(0, row - 1) : last] -= shade
    colour[2, max(0, row - 1) : last] += random.uniform(0, 0.5) * shade


def add_bands(colour: Strips, foot: float, random: np.random.Generator) -> None:
    """Change the strip between rows that are no foot: pavements, kerbs, shadows, courses. Those on the ground lean."""
    for _ in range(int(random.integers(1, 4))):
        first = int(random.integers(0, ROWS - 2))
        last = int(random.integers(first + 2, ROWS + 1)) if random.random() < 0.5 else ROWS + COLUMNS
        if foot >= 0 and min(abs(first - foot), abs(last - foot)) <= BESIDE:
            continue
        lean = random.uniform(-0.8, 0.8) * (np.arange(COLUMNS) - COLUMNS / 2)
        if random.random() < 0.6 or first + lean.min() <= foot + BESIDE:
            lean = np.zeros(COLUMNS)
        row = np.arange(ROWS)[:, None] - lean
        changed = (row >= first) & (row < last)
        colour += changed * random.normal(0, random.uniform(0.1, 0.9), (3, 1, 1))
        if random.random() < 0.3:
            colour += changed * faint_grain((ROWS, COLUMNS), random)


def as_if_small(colour: Strips, rows: int, columns: int) -> Strips:
    """As a photo of fewer pixels shows it, so many rows and columns a pixel."""
    smaller = colour[:, : ROWS - ROWS % rows, : COLUMNS - COLUMNS % columns]
    smaller = smaller.reshape(3, ROWS // rows, rows, COLUMNS // columns, columns).mean(axis=(2, 4))
    for axis, size, step in ((1, ROWS, rows), (2, COLUMNS, columns)):
        at = np.clip((np.arange(size) + 0.5) / step - 0.5, 0, smaller.shape[axis] - 1)
        before = np.minimum(at.astype(np.int64), max(0, smaller.shape[axis] - 2))
        after = np.minimum(before + 1, smaller.shape[axis] - 1)
        share = (at - before).reshape([-1 if number == axis else 1 for number in range(3)])
        smaller = np.asarray(smaller.take(before, axis) * (1 - share) + smaller.take(after, axis) * share, np.float32)
    return smaller


def repeated(strip: Strips, times: int) -> Strips:
    """A strip of a wall so many times as long, every other part mirrored."""
    parts = np.concatenate([strip if number % 2 == 0 else strip[:, :, ::-1] for number in range(times)], axis=2)
    parts = parts.reshape(LAYERS, ROWS, COLUMNS, times)
    found: Strips = parts.mean(axis=3)
    found[4] = parts[4].max(axis=2)
    return found


def add_bays(strip: Strips, foot: int, random: np.random.Generator) -> None:
    """Draw pillars and windows of other colours, down to the foot, with lines along their sides."""
    edges = np.sort(random.integers(0, COLUMNS, int(random.integers(2, 12))))
    tones = random.normal(0, random.uniform(0.2, 1), (3, 1, len(edges) + 1)) * np.array([1, 0.4, 0.4])[:, None, None]
    strip[:3, :foot] += np.repeat(tones, np.diff(edges, prepend=0, append=COLUMNS), axis=2)
    strip[4, int(random.integers(0, max(1, foot - 20))) : foot, edges] = 1


def add_things(strip: Strips, foot: int, random: np.random.Generator) -> None:
    """Draw what stands before a wall and hides a part of its foot: posts, people, cars; nearer feet are lower ones."""
    for _ in range(int(random.integers(1, 5))):
        width = int(random.integers(2, 7 * WIDE))
        left = int(random.integers(0, COLUMNS - width))
        top, last = int(random.integers(0, max(1, foot - 8))), min(ROWS, foot + int(random.integers(2, 45)))
        tone = random.normal(0, 1, (3, 1, 1))
        if random.random() < 0.5:
            tone = tone + random.normal(0, 0.6, (3, 1, width))
        strip[:3, top:last, left : left + width] = tone
        strip[4, top:last, left : left + width] = 0


def changed_example(strip: Strips, row: float, random: np.random.Generator) -> tuple[Strips, float]:
    """A strip (LAYERS, ROWS, COLUMNS) as another photo might show it, and its row; much changed, or a little."""
    is_much = random.random() < MUCH
    strip = strip[:, :, ::-1].copy() if random.random() < 0.5 else strip.copy()
    if random.random() < 0.5:  # a part of the wall
        first = int(random.integers(0, 12 * WIDE))
        last = int(random.integers(max(first + 12 * WIDE, 20 * WIDE), COLUMNS + 1))
        strip = strip[:, :, np.linspace(first, last - 1, COLUMNS).round().astype(np.int64)]
    if is_much:
        strip = change_wall(strip, row, random)
    else:
        change_a_little(strip[:3], row, random)
    if row >= 0 and random.random() < HEDGES and add_hedge(strip, round(row), random):
        row = UNSEEN
    change_light(strip[:3], random, is_much)
    if is_much and random.random() < 0.4:  # the photo ends higher up
        first = int(random.integers(max(int(row) + 5, 120), ROWS + 1)) if row < ROWS - 8 else ROWS
        strip[:5, first:] = 0
    strip[:3] *= strip[3]
    by = int(random.integers(-SHIFT, SHIFT + 1))
    if row >= 0 and not 4 < row + by < ROWS - 4:
        by = 0
    moved = np.zeros_like(strip)
    moved[:, max(0, by) : ROWS + min(0, by)] = strip[:, max(0, -by) : ROWS - max(0, by)]
    return moved, row + by if row >= 0 else row


def change_a_little(colour: Strips, row: float, random: np.random.Generator) -> None:
    """Other ground, and a band that is no foot."""
    if row >= 0:
        change_sides(colour, round(row), random, grain)
    elif random.random() < 0.3:
        colour += grain((ROWS, COLUMNS), random)
    if random.random() < BANDS:
        first = int(random.integers(0, ROWS - 2))
        last = int(random.integers(first + 2, ROWS + 1)) if random.random() < 0.5 else ROWS
        if row < 0 or min(abs(first - row), abs(last - row)) > BESIDE:
            colour[:, first:last] += random.normal(0, 0.4, (3, 1, 1))
            if random.random() < 0.4:
                colour[:, first:last] += grain((last - first, COLUMNS), random)


def change_wall(strip: Strips, row: float, random: np.random.Generator) -> Strips:
    """A longer wall, with other windows, foot and lines, things before it and bands on the ground."""
    if random.random() < 0.4:
        strip = repeated(strip, int(random.integers(2, 4)))
    colour = strip[:3]
    foot = round(row) if row >= 0 else int(random.integers(90, ROWS))
    if random.random() < 0.3:
        add_bays(strip, foot, random)
    if random.random() < 0.3:
        add_things(strip, foot, random)
    if row >= 0:
        change_foot(colour, strip[3], foot, random)
        if random.random() < JOINTS:
            add_joint(colour, foot, random)
    elif random.random() < 0.3:
        colour += faint_grain((ROWS, COLUMNS), random)
    if random.random() < MORE_BANDS:
        add_bands(colour, row, random)
    if random.random() < 0.15:
        strip[4] = 0
    if random.random() < JOINTS:
        add_joint(colour, int(random.integers(0, ROWS - 1)), random)
    return strip


def change_light(colour: Strips, random: np.random.Generator, is_much: bool) -> None:
    """Other light, noise, and something that stands before the wall; fewer pixels and other colours where `is_much`."""
    if random.random() < 0.25:
        colour[1:] = 0
    if is_much:
        colour *= np.where(random.random(3) < FLIPPED, -1, 1)[:, None, None]
    if random.random() < 0.25:  # light that changes down the wall
        above, below = random.normal(0, 0.6, 2).tolist()
        colour[:1] += np.linspace(above, below, ROWS)[:, None]
    colour *= random.uniform(0.6, 1.5, (3, 1, 1))
    colour += random.normal(0, 0.25, (3, 1, 1))
    if is_much and random.random() < 0.4:
        colour[:] = as_if_small(colour, int(random.integers(1, 8)), int(random.integers(1, 6)))
    if random.random() < 0.35:
        colour += random.normal(0, random.uniform(0.02, 0.15), colour.shape)
    if random.random() < 0.3:
        left, top = random.integers(0, COLUMNS - 4 * WIDE), random.integers(0, ROWS - 10)
        width, height = random.integers(3 * WIDE, 11 * WIDE), random.integers(8, 90)
        colour[:, top : top + height, left : left + width] = random.normal(0, 1, (3, 1, 1))
