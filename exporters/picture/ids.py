"""The ids of lines on the photo, as many as there is room for: they name a line in `--scale LINE=METRES`."""

import numpy as np

from exporters.colours import line_colour
from exporters.picture.canvas import Canvas, text_width
from linecad.arrays import Float
from linecad.scene import Scene

_SIZE, _ROW = 17, 18  # px: of the text, and how high its ground is
_MARGIN = 3  # px beside the text
_PLACES = (0.5, 0.35, 0.65, 0.2, 0.8)  # along a line, tried in turn
_GROUND, _OPACITY = (1.0, 1.0, 1.0), 0.85
_DARKER = 0.6  # of the colour of the line, so that the numbers can be read on white


def draw_ids(panel: Canvas, scene: Scene, ends: Float) -> int:
    """Write the ids of lines with `ends` (N, 2, 2) px of the panel onto them, and return of how many.

    Lines of component 0 come first, the longest first; an id that would cover another one is left out.
    """
    lines = scene.lines
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    order = np.lexsort((lines.id, -length, lines.component != 0))
    taken = np.zeros((panel.height, panel.width), bool)
    drawn = 0
    for row in order.tolist():
        text = str(lines.id[row])
        half = np.array([text_width(text, _SIZE) / 2 + _MARGIN, _ROW / 2])
        for share in _PLACES:
            middle = ends[row, 0] + share * (ends[row, 1] - ends[row, 0])
            low, high = np.floor(middle - half).astype(int), np.ceil(middle + half).astype(int)
            if (low < 0).any() or (high > (panel.width, panel.height)).any():
                continue
            here = taken[low[1] : high[1], low[0] : high[0]]
            if here.any():
                continue
            here[:] = True
            corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])], float)
            panel.tint([[corners]], _GROUND, _OPACITY)
            red, green, blue = (_DARKER * each for each in line_colour(int(lines.axis[row]), True))
            panel.text(middle[0], middle[1], text, _SIZE, (red, green, blue), "mm")
            drawn += 1
            break
    return drawn
