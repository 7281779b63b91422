"""A plot of time and memory against size, drawn with Pillow since the project has no plotting library."""

import math
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

PANEL, MARGIN = (620, 460), 70  # px
COLOURS = ("#1261a0", "#c2410c", "#15803d", "#7e22ce", "#444444")
RADIUS = 4  # px


@dataclass(frozen=True)
class Dot:
    """One solve."""

    column: str
    crossings: int
    seconds: float
    megabytes: float
    proven: bool


def draw_growth(file: Path, dots: list[Dot]) -> None:
    """Two panels with logarithmic axes: seconds, and MB, over the number of crossings; hollow dots are unproven."""
    image = Image.new("RGB", (2 * PANEL[0], PANEL[1] + 30), "white")
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(14)
    columns = list(dict.fromkeys(dot.column for dot in dots))
    for panel, (title, name) in enumerate((("seconds", "seconds"), ("peak memory of the process, MB", "megabytes"))):
        left, right = panel * PANEL[0] + MARGIN, (panel + 1) * PANEL[0] - 20
        x_axis = _Axis([dot.crossings for dot in dots], left, right)
        y_axis = _Axis([getattr(dot, name) for dot in dots], PANEL[1] - MARGIN, 50)
        for value, x in x_axis.ticks():
            draw.line((x, 50, x, PANEL[1] - MARGIN), fill="#dddddd")
            draw.text((x, PANEL[1] - MARGIN + 6), f"{value:,g}", fill="black", font=font, anchor="mt")
        for value, y in y_axis.ticks():
            draw.line((left, y, right, y), fill="#dddddd")
            draw.text((left - 6, y), f"{value:,g}", fill="black", font=font, anchor="rm")
        draw.text(((left + right) / 2, 30), title, fill="black", font=font, anchor="mm")
        draw.text(((left + right) / 2, PANEL[1] - 30), "crossings", fill="black", font=font, anchor="mm")
        for dot in dots:
            x, y = x_axis.at(dot.crossings), y_axis.at(getattr(dot, name))
            colour = COLOURS[columns.index(dot.column) % len(COLOURS)]
            box = (x - RADIUS, y - RADIUS, x + RADIUS, y + RADIUS)
            draw.ellipse(box, outline=colour, fill=colour if dot.proven else "white", width=2)
    for number, column in enumerate([*columns, "hollow: limit reached"]):
        colour = COLOURS[number % len(COLOURS)] if number < len(columns) else "black"
        draw.text((MARGIN + 150 * number, PANEL[1] + 8), column, fill=colour, font=font)
    image.save(file)


class _Axis:
    """A logarithmic scale from values to px, widened to whole decades."""

    def __init__(self, values: list[float], first: float, last: float) -> None:
        self.low = math.floor(math.log10(min(values)))
        self.high = max(math.ceil(math.log10(max(values))), self.low + 1)
        self.first, self.last = first, last

    def at(self, value: float) -> float:
        return self.first + (math.log10(value) - self.low) / (self.high - self.low) * (self.last - self.first)

    def ticks(self) -> list[tuple[float, float]]:
        return [(10.0**k, self.at(10.0**k)) for k in range(self.low, self.high + 1)]
