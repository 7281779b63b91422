"""Made scenes with wide windows, as of mills: python tests/benchmarks/wide_windows.py FOLDER [--scenes N] [--seed S]

Windows of `linecad dataset` are 1.7 m wide at most, and of two or three panes a row. Those of mills and of offices fill
most of a bay, in three to six lights between posts, which finding windows otherwise takes for as many windows.
"""

from dataclasses import replace
from unittest import mock

from high_rises import chosen_options, without_trim
from numpy.random import Generator

from linecad.dataset import houses
from linecad.dataset.facades import Style, draw_style
from linecad.dataset.make import make_dataset, plan_scenes

BAY, STOREY = (3.2, 6.5), (3.3, 4.6)  # m
WIDE, HIGH = (0.55, 0.88), (0.42, 0.72)  # share of bay and storey that is window
COLUMNS, ROWS = (3, 7), (1, 5)  # of panes
RECESS = (0.03, 0.3)  # m
PIER = (0.04, 0.2)  # m, that posts between bays stand off, where there are any
BARE = 0.5  # share of the houses without trim


def main() -> None:
    folder, options = chosen_options(__doc__, scenes=24, seed=19500, size="1280x720", samples=3)
    with mock.patch.object(houses, "draw_style", draw_wide_style):
        plans = plan_scenes(options, "street")
        made = make_dataset(folder, options, lambda stage: print(stage, flush=True), plans)
    print(f"{made.new} scenes made, {made.kept} were there already, in {folder}")


def draw_wide_style(rng: Generator) -> Style:
    """Windows that fill most of a bay, of many panes."""
    own = draw_style(rng)
    bay, storey = float(rng.uniform(*BAY)), float(rng.uniform(*STOREY))
    if rng.random() < BARE:
        own = without_trim(own)
    return replace(
        own,
        bay=bay,
        storey=storey,
        window=(bay * float(rng.uniform(*WIDE)), storey * float(rng.uniform(*HIGH))),
        recess=float(rng.uniform(*RECESS)),
        panes=(int(rng.integers(*COLUMNS)), int(rng.integers(*ROWS))),
        pilaster=float(rng.uniform(*PIER)) if rng.random() < 1 / 2 else 0.0,
        balconies=0.0,
        blinds=own.blinds / 2,
    )


if __name__ == "__main__":
    main()
