"""Which simulated photos are made of each scene, and a folder that keeps them: the same photos for the same seed."""

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.random import Generator
from simulated import SUPER, Canvas, Shot, bent, cropped, draw_canvas, draw_shot, finished, turned, with_turned_house

from linecad.arrays import Float

RECIPE = 1  # counts the changes of what is made, so that a folder with older photos is not taken for the new ones
RADIAL = (-0.3, 0.1)  # k1
LEAST_SLOPE = 0.3  # of the distorted over the straight radius in the corners; lenses that fold are none
LARGEST_CUT = 0.3  # of width and of height
MOST_ROLL, LEAST_ROLL = np.radians(45.0), np.radians(8.0)


@dataclass(frozen=True, eq=False)
class Made:
    """A photo on disk with its true camera."""

    name: str
    kind: str
    path: Path
    matrix: Float  # (3, 3) K, px
    rotation: Float  # (3, 3) world to camera
    radial: float  # k1
    size: tuple[int, int]  # px, width and height
    second: Float | None  # (3, 3) the frame of a turned house; which of the two a photo shows more of is not known


def _plain(canvas: Canvas, _rng: Generator) -> Canvas:
    return canvas


def _bent(canvas: Canvas, rng: Generator) -> Canvas:
    """Bent by a lens, but never so much that the picture would nearly fold."""
    height, width = canvas.pixels.shape[:2]
    reach = np.hypot(width, height) / 2 / canvas.matrix[0, 0]
    return bent(canvas, max(float(rng.uniform(*RADIAL)), -(1 - LEAST_SLOPE) / (3 * reach**2)))


def _cropped(canvas: Canvas, rng: Generator) -> Canvas:
    height, width = canvas.pixels.shape[:2]
    kept_width, kept_height = (int(side * (1 - rng.uniform(0, LARGEST_CUT))) for side in (width, height))
    left, top = int(rng.integers(0, width - kept_width + 1)), int(rng.integers(0, height - kept_height + 1))
    return cropped(canvas, left, top, kept_width, kept_height)


def _upside_down(canvas: Canvas, _rng: Generator) -> Canvas:
    return turned(canvas, 2)


def _on_its_side(canvas: Canvas, rng: Generator) -> Canvas:
    return turned(canvas, int(rng.choice([1, 3])))


CHANGES: dict[str, Callable[[Canvas, Generator], Canvas]] = {
    "plain": _plain,
    "bent": _bent,
    "cropped": _cropped,
    "rolled": _plain,  # these two are drawn anew
    "turned house": _plain,
    "upside down": _upside_down,
    "on its side": _on_its_side,
}
PLAIN, ROLLED, TURNED_HOUSE = "plain", "rolled", "turned house"


def kinds_of(index: int) -> tuple[str, str]:
    """The kinds of photo that are made of scene `index`: the plain one and another."""
    others = [kind for kind in CHANGES if kind != PLAIN]
    # Not the remainder alone: scenes repeat their kinds every ten.
    return PLAIN, others[(index + index // 10) % len(others)]


def simulated_photos(folder: Path, seed: int, count: int) -> Iterator[Made]:
    """The photos of `count` scenes."""
    for index in range(count):
        for kind in kinds_of(index):
            yield simulated_photo(folder, seed, index, kind)


def simulated_photo(folder: Path, seed: int, index: int, kind: str) -> Made:
    """The photo of a kind of scene `index` of a seed, made where the folder does not have it yet."""
    name = f"{RECIPE}-{seed}-{index:04d}-{kind.replace(' ', '-')}"
    path = folder / f"{name}.jpg"
    if not path.with_suffix(".json").is_file():
        folder.mkdir(parents=True, exist_ok=True)
        rng = np.random.default_rng([seed, index, list(CHANGES).index(kind)])
        _store(_draw(seed, index, kind, rng), path, rng)
    known = json.loads(path.with_suffix(".json").read_text())
    size = (known["size"][0], known["size"][1])
    second = np.array(known["second"]) if "second" in known else None
    return Made(name, kind, path, np.array(known["K"]), np.array(known["R"]), known["k1"], size, second)


def _draw(seed: int, index: int, kind: str, rng: Generator) -> Canvas:
    if kind not in (ROLLED, TURNED_HOUSE):
        return CHANGES[kind](_plain_canvas(seed, index), rng)
    shot = draw_shot(seed, index)
    light = np.random.default_rng([seed, index, 100])
    if kind == ROLLED:
        return draw_canvas(_rolled(shot, rng), light)
    shot, turn = with_turned_house(shot, rng)
    canvas = draw_canvas(shot, light)
    return replace(canvas, second=canvas.rotation @ turn)


@lru_cache(maxsize=1)  # of a scene two photos are made, one after the other
def _plain_canvas(seed: int, index: int) -> Canvas:
    return draw_canvas(draw_shot(seed, index), np.random.default_rng([seed, index, 100]))


def _rolled(shot: Shot, rng: Generator) -> Shot:
    roll = float(rng.choice([-1, 1]) * rng.uniform(LEAST_ROLL, MOST_ROLL))
    return replace(shot, view=replace(shot.view, roll=roll))


def _store(canvas: Canvas, path: Path, rng: Generator) -> None:
    """Write the photo, then its truth, so that a photo without one is made again."""
    data, matrix = finished(canvas, rng)
    size = [side // SUPER for side in canvas.pixels.shape[1::-1]]
    path.write_bytes(data)
    known = {"K": matrix.tolist(), "R": canvas.rotation.tolist(), "k1": canvas.radial, "size": size}
    if canvas.second is not None:
        known["second"] = canvas.second.tolist()
    half = path.with_suffix(f".{os.getpid()}")
    half.write_text(json.dumps(known))
    half.replace(path.with_suffix(".json"))
