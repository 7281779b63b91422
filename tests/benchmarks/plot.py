"""A plot of time and memory against size, drawn with Pillow since the project has no plotting library."""

import math
import statistics
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

PANEL, MARGIN = (620, 460), 70  # px
COLOURS = ("#1261a0", "#c2410c", "#15803d", "#7e22ce", "#444444")
RADIUS = 4  # px
MOST_TICKS = 10  # of an axis; beyond, decades alone


@dataclass(frozen=True)
class Dot:
    """One solve."""

    column: str
    size: str
    crossings: int
    seconds: float
    megabytes: float
    proven: bool


def draw_growth(file: Path, dots: list[Dot], ladder: tuple[str, ...]) -> None:
    """Two panels with logarithmic axes: seconds, and MB, over the number of crossings; hollow dots are unproven.

    A line for each column goes through the medians of the sizes in `ladder`.
    """
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
        for number, column in enumerate(columns):
            medians = []
            for size in ladder:
                there = [dot for dot in dots if (dot.column, dot.size) == (column, size)]
                if there:
                    middle = statistics.median(dot.crossings for dot in there)
                    medians.append((x_axis.at(middle), y_axis.at(statistics.median(getattr(d, name) for d in there))))
            draw.line(medians, fill=COLOURS[number % len(COLOURS)], width=2)
        for dot in dots:
            x, y = x_axis.at(dot.crossings), y_axis.at(getattr(dot, name))
            colour = COLOURS[columns.index(dot.column) % len(COLOURS)]
            box = (x - RADIUS, y - RADIUS, x + RADIUS, y + RADIUS)
            draw.ellipse(box, outline=colour, fill=colour if dot.proven else "white", width=2)
    for number, column in enumerate([*columns, "hollow: limit reached; lines: medians of a size"]):
        colour = COLOURS[number % len(COLOURS)] if number < len(columns) else "black"
        draw.text((MARGIN + 150 * number, PANEL[1] + 8), column, fill=colour, font=font)
    image.save(file)


class _Axis:
    """A logarithmic scale from values to px, widened to the next ticks, which are 1, 2 and 5 of each decade."""

    def __init__(self, values: list[float], first: float, last: float) -> None:
        decades = range(math.floor(math.log10(min(values))), math.ceil(math.log10(max(values))) + 1)
        marks = [digit * 10.0**decade for decade in decades for digit in (1, 2, 5)]
        self.low = max(mark for mark in marks if mark <= min(values))
        self.high = min(mark for mark in marks if mark > max(values))
        self.marks = [mark for mark in marks if self.low <= mark <= self.high]
        if len(self.marks) > MOST_TICKS:
            self.marks = [mark for mark in self.marks if math.log10(mark).is_integer()]
        self.first, self.last = first, last

    def at(self, value: float) -> float:
        share = math.log10(value / self.low) / math.log10(self.high / self.low)
        return self.first + share * (self.last - self.first)

    def ticks(self) -> list[tuple[float, float]]:
        return [(mark, self.at(mark)) for mark in self.marks]
