"""Plots of tables as SVG: bars with their intervals, and probability as stated against what it is."""

from html import escape

from linecad.evaluation.bootstrap import Estimate
from linecad.evaluation.table import Table

BAR_WIDTH, BAR_HEIGHT, LABEL_WIDTH = 420, 18, 150  # px
SIDE, LEFT, TOP, BELOW = 320, 50, 24, 40  # px, of the square of the calibration plot, and of the room for its labels
HALF_WIDTH = 0.1  # of the band around the diagonal in which a probability holds


def draw_bars(table: Table, column: int) -> str:
    """Bars with intervals for one column of shares, as SVG."""
    width, height = LABEL_WIDTH * 2 + BAR_WIDTH, BAR_HEIGHT * (len(table.rows) + 1)
    lines = [
        f'<figure><svg viewBox="0 0 {width} {height}" width="{width}" role="img" font-size="12">',
        f"<title>{escape(table.title)}: {escape(table.columns[column].name)}</title>",
    ]
    left = 2 * LABEL_WIDTH - 50
    for tick in range(0, 101, 20):
        x = left + BAR_WIDTH * tick / 100
        lines.append(f'<line x1="{x}" x2="{x}" y1="0" y2="{height - BAR_HEIGHT}" stroke="#ddd"/>')
        lines.append(f'<text x="{x}" y="{height - 4}" text-anchor="middle" fill="#555">{tick} %</text>')
    for index, row in enumerate(table.rows):
        y = index * BAR_HEIGHT
        lines.append(f'<text x="{left - 6}" y="{y + 13}" text-anchor="end">{escape(row.name)}</text>')
        cell = row.cells[column]
        if cell is not None:
            lines += _bar(cell, left, y)
    return "\n".join([*lines, f"</svg><figcaption>{escape(table.columns[column].name)}</figcaption></figure>"])


def _bar(cell: Estimate, left: float, y: float) -> list[str]:
    length, low, high = (BAR_WIDTH * min(max(share, 0.0), 1.0) for share in (cell.value, cell.low, cell.high))
    middle = y + BAR_HEIGHT / 2
    return [
        f'<rect x="{left}" y="{y + 3}" width="{length:.1f}" height="{BAR_HEIGHT - 6}" fill="#7fa8d9"/>',
        f'<line x1="{left + low:.1f}" x2="{left + high:.1f}" y1="{middle}" y2="{middle}" stroke="#222" '
        'stroke-width="2"/>',
    ]


def draw_calibration(table: Table) -> str:
    """The table of `tables.calibration`: the share that is right, with its interval, over the stated probability."""
    width, height = LEFT + SIDE + 20, TOP + SIDE + BELOW
    band = [(0, -1), (1, -1), (1, 1), (0, 1)]  # along the diagonal, and to either side of it
    corners = " ".join("{},{}".format(*_place(at, at + side * HALF_WIDTH)) for at, side in band)
    lines = [
        f'<figure><svg viewBox="0 0 {width} {height}" width="{width}" role="img" font-size="12">',
        f"<title>{escape(table.title)}</title>",
        f'<svg x="{LEFT}" y="{TOP}" width="{SIDE}" height="{SIDE}" overflow="hidden">',
        f'<polygon points="{corners}" fill="#e8f0e8"/>',
        f'<line x1="0" y1="{SIDE}" x2="{SIDE}" y2="0" stroke="#7a9a7a"/>',
        f'<rect width="{SIDE}" height="{SIDE}" fill="none" stroke="#888"/></svg>',
    ]
    for tick in range(0, 101, 20):
        x, y = _place(tick / 100, tick / 100)
        lines.append(f'<text x="{LEFT + x}" y="{TOP + SIDE + 16}" text-anchor="middle" fill="#555">{tick} %</text>')
        lines.append(f'<text x="{LEFT - 6}" y="{TOP + y + 4}" text-anchor="end" fill="#555">{tick} %</text>')
    lines.append(f'<text x="{LEFT + SIDE / 2}" y="{height - 4}" text-anchor="middle">stated</text>')
    lines.append(f'<text x="{LEFT}" y="{TOP - 8}">right within 5 %</text>')
    for row in table.rows:
        points, stated, right = row.cells
        if points is not None and stated is not None and right is not None:
            lines += _tenth(f"{row.name}: {points.value:.0f} points", stated.value, right)
    return "\n".join([*lines, "</svg></figure>"])


def _tenth(name: str, stated: float, right: Estimate) -> list[str]:
    (x, y), (_, low), (_, high) = (_place(stated, share) for share in (right.value, right.low, right.high))
    x, y, low, high = x + LEFT, y + TOP, low + TOP, high + TOP
    return [
        f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{low:.1f}" y2="{high:.1f}" stroke="#222" stroke-width="1.5"/>',
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="#7fa8d9" stroke="#222">',
        f"<title>{escape(name)}</title></circle>",
    ]


def _place(stated: float, right: float) -> tuple[float, float]:
    """Where two shares lie in the square, px."""
    return stated * SIDE, (1 - right) * SIDE
