"""What a cue is: a function from what is known to evidence about edges or lines of a line graph."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float
from linecad.line_graph import LineDepths, LineGraph, ManhattanFrame
from linecad.scene import Camera


@dataclass(frozen=True, eq=False)
class Known:
    """What a cue may look at."""

    graph: LineGraph  # its weights are what the cues are about to make
    camera: Camera
    frame: ManhattanFrame
    pixels: NDArray[np.uint8] | None  # (H, W, 3) RGB of the straightened photo; None where there is none to look at


Cue = Callable[[Known], Float]  # (E,) log-odds that the edges are real, 0 where the cue says nothing
UnaryCue = Callable[[Known], LineDepths]
