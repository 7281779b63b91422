"""Made scenes with walls of rough old brick: python tests/benchmarks/rough_brick.py FOLDER [--seed S] [--spread TONE]

Bricks of `linecad dataset` differ by 0.14 of their tone. Those of old walls differ by far more, which is what finding
windows has to learn: around windows they have edges too.
"""

import argparse
from dataclasses import replace
from pathlib import Path

from linecad.dataset import facades, textures
from linecad.dataset.make import DatasetOptions, make_dataset
from linecad.dataset.modelling import Pattern, Point

COLOURS: tuple[Point, ...] = ((0.56, 0.33, 0.26), (0.66, 0.50, 0.37), (0.60, 0.48, 0.42), (0.47, 0.31, 0.27))
TILE = 4.0  # m; a smaller one repeats so often that its bricks stand in rows and columns
JOINT_TONE = 1.3
TEXELS = 2048
BRICK: Pattern = "brick"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", type=int, default=10)
    parser.add_argument("--seed", type=int, default=61500)
    parser.add_argument("--spread", type=float, default=0.3, help="of the tone from brick to brick (0.3)")
    parser.add_argument("--samples", type=int, default=8, help="rays a pixel (8)")
    chosen = parser.parse_args()
    facades.WALLS = tuple((BRICK, colour) for colour in COLOURS)
    textures.FINE = TEXELS
    brick = textures.COURSES[BRICK]
    textures.COURSES[BRICK] = replace(brick, tile=TILE, spread=chosen.spread, joint_tone=JOINT_TONE)
    options = DatasetOptions(chosen.scenes, chosen.seed, 1920, 1080, chosen.samples)
    made = make_dataset(chosen.folder, options, lambda stage: print(stage, flush=True))
    print(f"{made.new} scenes made, {made.kept} were there already, in {chosen.folder}")


if __name__ == "__main__":
    main()
