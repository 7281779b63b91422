"""Made scenes of high-rise blocks: python tests/benchmarks/high_rises.py FOLDER [--scenes N] [--seed S] [--size WxH]

Houses of `linecad dataset` have six storeys at most and one kind of window each, with a frame, bars and a sill. Offices
and blocks of flats have twenty storeys of small windows, many of them bare holes close to each other, between posts
or in strips, which is what finding windows has to learn too.
"""

import argparse
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float
from linecad.dataset import choice, facades, houses, scenes
from linecad.dataset.facades import Style, draw_style
from linecad.dataset.furniture import add_traffic
from linecad.dataset.make import DatasetOptions, make_dataset, plan_scenes
from linecad.dataset.modelling import Material, Model, X, Y

HEIGHT = (14.0, 65.0)  # m
BAY, STOREY = (1.3, 3.4), (2.7, 3.9)  # m
WIDE, HIGH = (0.35, 0.88), (0.32, 0.72)  # share of bay and storey that is window
PANES = ((1, 1), (1, 1), (2, 1), (1, 2), (3, 1), (2, 2))
RECESS = (0.015, 0.3)  # m
BARE = 0.6  # share of the blocks without trim
LEAST_FLANK = 0.2  # m
REACH = 250.0  # m, to which windows have frames


def main() -> None:
    folder, options = chosen_options(__doc__, scenes=40, seed=18000, size="640x480", samples=4)
    choice.CROSSINGS["street"], choice.LARGEST_WALL["street"] = (100, 100_000), 0.45
    facades.LEAST_FLANK = LEAST_FLANK
    houses.DETAIL_REACH = REACH
    with mock.patch.object(scenes, "_street", draw_blocks), mock.patch.object(houses, "draw_style", draw_tall_style):
        made = make_dataset(folder, options, lambda stage: print(stage, flush=True), plan_scenes(options, "street"))
    print(f"{made.new} scenes made, {made.kept} were there already, in {folder}")


def chosen_options(doc: str | None, scenes: int, seed: int, size: str, samples: int) -> tuple[Path, DatasetOptions]:
    """The folder and the options that the command line chose, whose help is `doc`, or these."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", type=int, default=scenes)
    parser.add_argument("--seed", type=int, default=seed)
    parser.add_argument("--size", default=size, help=f"of the photos ({size})")
    parser.add_argument("--samples", type=int, default=samples, help=f"rays a pixel ({samples})")
    chosen = parser.parse_args()
    width, height = map(int, chosen.size.split("x"))
    return chosen.folder, DatasetOptions(chosen.scenes, chosen.seed, width, height, chosen.samples)


def draw_blocks(rng: Generator) -> tuple[Model, Float, float]:
    """Blocks on both sides of a road, of which the nearest ones show two walls, and others behind them."""
    model = Model()
    side = float(rng.choice([-1.0, 1.0]))
    road = float(rng.uniform(5, 12))
    eye = np.array([rng.uniform(-0.5, 0.5) * road, 0.0, rng.uniform(*scenes.CAMERA_HEIGHT)])
    for sign in (-1.0, 1.0):
        y = float(rng.uniform(8, 40))
        while y < 130:
            wide, deep = float(rng.uniform(12, 40)), float(rng.uniform(14, 40))
            front = sign * (road + float(rng.uniform(2.5, 9)))
            across = (min(front, front + sign * wide), max(front, front + sign * wide))
            fronts = {"+x" if sign < 0 else "-x", "-y"}
            houses.add_building(model, across, (y, y + deep), (0.0, float(rng.uniform(*HEIGHT))), fronts, rng)
            y += deep + float(rng.choice([0.0, rng.uniform(4, 25)]))
    scenes._add_road(model, road, 150.0)
    model.quad(np.array([-90.0, -35.0, -0.02]), 180 * X, 260 * Y, scenes.SLABS)
    add_traffic(model, road, rng)
    return model, eye, side


def draw_tall_style(rng: Generator) -> Style:
    """Small windows close to each other, often bare holes."""
    own = draw_style(rng)
    bay, storey = float(rng.uniform(*BAY)), float(rng.uniform(*STOREY))
    window = bay * float(rng.uniform(*WIDE)), storey * float(rng.uniform(*HIGH))
    if rng.random() < BARE:
        own = without_trim(own)
    return replace(
        own,
        bay=bay,
        storey=storey,
        window=window,
        ground=float(rng.uniform(3.5, 6.0)),
        recess=float(rng.uniform(*RECESS)),
        panes=PANES[rng.integers(len(PANES))],
        wall=Material("plain", own.wall.colour) if rng.random() < 0.5 else own.wall,
        balconies=0.0 if rng.random() < 0.8 else own.balconies,
        course=own.course if rng.random() < 0.4 else 0.0,
    )


def without_trim(style: Style) -> Style:
    """The style without what stands off the wall around windows and at corners."""
    return replace(style, sill_course=0.0, head_course=0.0, surround=0.0, lintel=0.0, quoin=0.0)


if __name__ == "__main__":
    main()
