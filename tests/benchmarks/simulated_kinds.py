"""Which simulated photos are made of each scene, and a folder that keeps them: the same photos for the same seed."""

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.random import Generator
from simulated import Canvas, Shot, bent, cropped, draw_canvas, draw_shot, finished, turned

from linecad.scene import Float

RECIPE = 1  # counts the changes of what is made, so that a folder with older photos is not taken for the new ones
BENT_EVERY = 5  # each of the kinds but the plain one is made of one scene in so many
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
    "rolled": _plain,  # the camera itself is rolled
    "upside down": _upside_down,
    "on its side": _on_its_side,
}
PLAIN, ROLLED = "plain", "rolled"


def kinds_of(index: int) -> tuple[str, str]:
    """The kinds of photo that are made of scene `index`: the plain one and another."""
    others = [kind for kind in CHANGES if kind != PLAIN]
    # Not the remainder of 5 alone: scenes repeat their kinds every ten.
    return PLAIN, others[(index + index // 10) % BENT_EVERY]


def simulated_photos(folder: Path, seed: int, count: int) -> Iterator[Made]:
    """The photos of `count` scenes, made where the folder does not have them yet."""
    folder.mkdir(parents=True, exist_ok=True)
    for index in range(count):
        shot, canvas = None, None
        for kind in kinds_of(index):
            name = f"{RECIPE}-{seed}-{index:04d}-{kind.replace(' ', '-')}"
            path = folder / f"{name}.jpg"
            if not path.with_suffix(".json").is_file():
                rng = np.random.default_rng([seed, index, list(CHANGES).index(kind)])
                shot = shot or draw_shot(seed, index)
                if kind == ROLLED:
                    own = draw_canvas(_rolled(shot, rng), np.random.default_rng([seed, index, 100]))
                else:
                    canvas = canvas or draw_canvas(shot, np.random.default_rng([seed, index, 100]))
                    own = CHANGES[kind](canvas, rng)
                _store(own, path, rng)
            known = json.loads(path.with_suffix(".json").read_text())
            yield Made(name, kind, path, np.array(known["K"]), np.array(known["R"]), known["k1"])


def _rolled(shot: Shot, rng: Generator) -> Shot:
    roll = float(rng.choice([-1, 1]) * rng.uniform(LEAST_ROLL, MOST_ROLL))
    return replace(shot, view=replace(shot.view, roll=roll))


def _store(canvas: Canvas, path: Path, rng: Generator) -> None:
    """Write the photo, then its truth, so that a photo without one is made again."""
    data, matrix = finished(canvas, rng)
    path.write_bytes(data)
    known = {"K": matrix.tolist(), "R": canvas.rotation.tolist(), "k1": canvas.radial}
    half = path.with_suffix(f".{os.getpid()}")
    half.write_text(json.dumps(known))
    half.replace(path.with_suffix(".json"))
