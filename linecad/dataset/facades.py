"""Facades: a style drawn at random, and the storeys, windows, doors, courses and balconies that it leads to."""

from dataclasses import dataclass

from numpy.random import Generator

from linecad.dataset.modelling import UP, Interval, Material, Pattern, Point, Wall, tinted

RECESS = (0.04, 0.14)  # m, of windows behind the wall
FRAME = 0.07  # m, width of a window's frame
BAR = 0.045  # m, width of the bars between panes
FRAME_DEEP = 0.045  # m, frames stand before the glass
DOOR = 1.1  # m, width
POST = 0.2  # m, width of the posts beside a door
CORNICE = 0.35  # m, height of the cornice
PARAPET = 0.35  # m, from the cornice to the roof's edge
HEAD = 0.17  # m, height of lintels
LEAST_FLANK = 0.45  # m of wall between a window and the wall's end

WALLS: tuple[tuple[Pattern, Point], ...] = (
    ("brick", (0.56, 0.33, 0.26)),
    ("brick", (0.66, 0.50, 0.37)),
    ("brick", (0.47, 0.31, 0.27)),
    ("plain", (0.84, 0.79, 0.69)),
    ("plain", (0.78, 0.64, 0.48)),
    ("plain", (0.68, 0.71, 0.69)),
    ("plain", (0.87, 0.86, 0.82)),
    ("plain", (0.74, 0.60, 0.55)),
    ("panel", (0.74, 0.75, 0.73)),
    ("ashlar", (0.73, 0.69, 0.62)),
)
TRIMS: tuple[Point, ...] = ((0.80, 0.77, 0.71), (0.70, 0.66, 0.58), (0.88, 0.87, 0.84), (0.60, 0.57, 0.53))
FRAMES: tuple[Point, ...] = ((0.90, 0.89, 0.86), (0.90, 0.89, 0.86), (0.20, 0.19, 0.18), (0.30, 0.22, 0.16))
DOORS: tuple[Point, ...] = ((0.28, 0.20, 0.15), (0.16, 0.24, 0.20), (0.36, 0.14, 0.12), (0.20, 0.24, 0.34))
TILES: tuple[Point, ...] = ((0.50, 0.25, 0.19), (0.42, 0.24, 0.20), (0.36, 0.33, 0.32), (0.55, 0.32, 0.23))
GLASS = Material("glass", (0.11, 0.13, 0.14))
BLIND = Material("plain", (0.80, 0.76, 0.68))
IRON = Material("plain", (0.17, 0.18, 0.19))


@dataclass(frozen=True)
class Style:
    """What is the same all over one building; lengths in m, out of the wall where they stand off it."""

    wall: Material
    base: Material  # the ground floor
    trim: Material
    frame: Material
    door: Material
    ground: float  # height of the ground floor
    storey: float
    bay: float  # from window to window
    window: tuple[float, float]  # width and height
    recess: float
    panes: tuple[int, int]  # columns and rows
    shops: bool
    course: float  # string courses at each floor; 0 where there are none
    sill_course: float  # courses that join the sills; 0 where there are none
    head_course: float  # courses above the windows; 0 where there are none
    pilaster: float  # between the bays; 0 where there are none
    quoin: float  # pilasters at the corners; 0 where there are none
    surround: float  # flat frames around windows; 0 where there are none
    lintel: float  # 0 where there are none
    balconies: float  # share of the windows
    blinds: float  # share of the windows
    cornice: float
    plinth: float = 0.5  # height; 0 where there is none


def draw_style(rng: Generator) -> Style:
    """A style of its own for each building."""

    def pick(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    def perhaps(chance: float, low: float, high: float) -> float:
        value = pick(low, high)
        return value if rng.random() < chance else 0.0

    def varied(colour: Point) -> Point:
        return tinted(colour, rng.normal(1.0, 0.06), rng.normal(0.0, 0.012, 3))

    pattern, colour = WALLS[rng.integers(len(WALLS))]
    wall = Material(pattern, varied(colour))
    trim = Material("plain", varied(TRIMS[rng.integers(len(TRIMS))]))
    base = (wall, Material("ashlar", trim.colour), trim)[rng.integers(3)]
    bay = pick(2.1, 3.3)
    width = min(pick(0.9, 1.7), bay - 0.8)
    storey = pick(2.9, 3.6)
    return Style(
        wall=wall,
        base=base,
        trim=trim,
        frame=Material("plain", FRAMES[rng.integers(len(FRAMES))]),
        door=Material("plain", DOORS[rng.integers(len(DOORS))]),
        ground=pick(3.3, 4.3),
        storey=storey,
        bay=bay,
        window=(width, min(pick(1.3, 2.1), storey - 1.1)),
        recess=pick(*RECESS),
        panes=(int(rng.integers(2, 4)), int(rng.integers(2, 6))),
        shops=bool(rng.random() < 0.6),
        course=perhaps(0.7, 0.05, 0.09),
        sill_course=perhaps(0.6, 0.03, 0.055),
        head_course=perhaps(0.5, 0.03, 0.055),
        pilaster=perhaps(0.5, 0.06, 0.1),
        quoin=perhaps(0.4, 0.14, 0.2),
        surround=perhaps(0.5, 0.025, 0.05),
        lintel=perhaps(0.5, 0.04, 0.07),
        balconies=perhaps(0.25, 0.15, 0.4),
        blinds=pick(0.0, 0.5),
        cornice=pick(0.22, 0.45),
    )


def build_facade(wall: Wall, width: float, height: float, style: Style, rng: Generator, detailed: bool = True) -> None:
    """Add a facade of `width` x `height` m; without detail, windows are single panes and have no trim."""
    floors = max(1, int((height - style.ground - CORNICE - PARAPET) // style.storey))
    bays = max(1, int((width - 2 * LEAST_FLANK) // style.bay))
    margin = (width - bays * style.bay) / 2
    middles = [margin + (index + 0.5) * style.bay for index in range(bays)]
    door = int(rng.integers(bays))
    head = style.ground - 0.75
    for index, middle in enumerate(middles):
        if index == door:
            _add_door(wall, (middle - DOOR / 2, middle + DOOR / 2), head, style)
            continue
        half = (style.bay - 0.75) / 2 if style.shops else style.window[0] / 2
        sill = 0.75 if style.shops else 1.15
        _add_window(wall, (middle - half, middle + half), (sill, head), style, rng, detailed, (2, 1))
    for floor in range(floors):
        bottom = style.ground + floor * style.storey + (style.storey - style.window[1]) * 0.55
        for middle in middles:
            along = (middle - style.window[0] / 2, middle + style.window[0] / 2)
            _add_window(wall, along, (bottom, bottom + style.window[1]), style, rng, detailed, style.panes)
            if detailed and rng.random() < style.balconies:
                _add_balcony(wall, (along[0] - 0.35, along[1] + 0.35), bottom - 0.3, style)
    for start, end in ((0.0, middles[door] - DOOR / 2 - POST), (middles[door] + DOOR / 2 + POST, width)):
        if style.plinth:
            wall.box((start, end), (0.0, style.plinth), (0.0, 0.075), style.trim, "-c -b")
    _add_bands(wall, width, height, floors, style, detailed)
    if style.pilaster and detailed:
        # Posts end below the cornice and stand less far off than it.
        for index in range(bays + 1):
            middle = min(max(margin + index * style.bay, 0.2), width - 0.2)
            if not (style.quoin and index in (0, bays)):
                up = (style.plinth + 0.05 if style.plinth else 0.0, height - PARAPET - CORNICE - 0.25)
                wall.box((middle - 0.17, middle + 0.17), up, (0.0, style.pilaster), style.trim, "-c -b +b")
    wall.build((0.0, width), (0.0, style.ground - 0.2), style.base)
    wall.build((0.0, width), (style.ground - 0.2, height), style.wall)
    if style.base != style.wall and not style.course:
        wall.model.edge(wall.at(0, style.ground - 0.2), wall.at(width, style.ground - 0.2))


def _add_bands(wall: Wall, width: float, height: float, floors: int, style: Style, detailed: bool) -> None:
    """String courses, sill courses and cornice, all over the width."""
    along = (0.0, width)
    top = height - PARAPET
    for floor in range(floors if detailed else 0):
        level = style.ground + floor * style.storey
        if style.course:
            wall.box(along, (level - 0.2, level), (0.0, style.course), style.trim)
        if style.sill_course:
            bottom = level + (style.storey - style.window[1]) * 0.55
            wall.box(along, (bottom - 0.22, bottom - 0.1), (0.0, style.sill_course), style.trim)
        if style.head_course:
            head = level + (style.storey - style.window[1]) * 0.55 + style.window[1] + HEAD
            wall.box(along, (head, head + 0.12), (0.0, style.head_course), style.trim)
    wall.box(along, (top - CORNICE - 0.25, top - CORNICE), (0.0, 0.145), style.trim, "-c +b")
    wall.box(along, (top - CORNICE, top), (0.0, style.cornice), style.trim)
    if style.quoin:
        for start in (0.0, width - 0.5):
            wall.box(
                (start, start + 0.5),
                (style.plinth, top - CORNICE - 0.25),
                (0.0, style.quoin - 0.005),
                style.trim,
                "-c +b",
            )


def _add_window(
    wall: Wall,
    along: Interval,
    up: Interval,
    style: Style,
    rng: Generator,
    detailed: bool,
    panes: tuple[int, int],
) -> None:
    drop, has_blind = float(rng.uniform(0.15, 0.6)), rng.random() < style.blinds
    if not detailed:
        wall.openings.append((along, up))
        wall.name_opening(along, up)
        sides = ((along[1] - along[0]) * wall.along, (up[1] - up[0]) * UP)
        wall.model.outline(wall.at(along[0], up[0]), *sides, GLASS)
        return
    wall.opening(along, up, style.recess, style.trim if style.surround else style.wall)
    wall.panel(along, up, -style.recess, GLASS)
    if has_blind:
        high = drop * (up[1] - up[0])
        corner = wall.at(along[0], up[1] - high, -style.recess + 0.008)
        wall.model.outline(corner, (along[1] - along[0]) * wall.along, high * UP, BLIND)
    _add_bars(wall, along, up, style, panes)
    wall.box((along[0] - 0.1, along[1] + 0.1), (up[0] - 0.09, up[0]), (0.0, 0.09), style.trim)
    if style.surround:
        for start, end in ((along[0] - 0.15, along[0]), (along[1], along[1] + 0.15)):
            wall.box((start, end), up, (0.0, style.surround), style.trim, "-c -b")
    if style.surround or style.lintel:
        over = 0.15 if style.surround else 0.1
        out = max(style.surround, style.lintel)
        wall.box((along[0] - over, along[1] + over), (up[1], up[1] + HEAD), (0.0, out), style.trim)


def _add_bars(wall: Wall, along: Interval, up: Interval, style: Style, panes: tuple[int, int]) -> None:
    """A window's frame and the bars between its panes."""
    out = (-style.recess, -style.recess + min(FRAME_DEEP, 0.75 * style.recess))
    for start, hidden in ((along[0], "-a"), (along[1] - FRAME, "+a")):
        wall.box((start, start + FRAME), up, out, style.frame, f"-c -b +b {hidden}")
    inner = (along[0] + FRAME, along[1] - FRAME)
    for start, hidden in ((up[0], "-b"), (up[1] - FRAME, "+b")):
        wall.box(inner, (start, start + FRAME), out, style.frame, f"-c -a +a {hidden}")
    # Bars of different directions stand off differently, or their fronts would lie in one plane.
    columns, rows = panes
    heights = (up[0] + FRAME, up[1] - FRAME)
    for index in range(1, columns):
        middle = inner[0] + (inner[1] - inner[0]) * index / columns
        bar = (middle - BAR / 2, middle + BAR / 2)
        wall.box(bar, heights, (out[0], out[1] - 0.004), style.frame, "-c -b +b")
    for index in range(1, rows):
        middle = heights[0] + (heights[1] - heights[0]) * index / rows
        bar = (middle - BAR / 2, middle + BAR / 2)
        wall.box(inner, bar, (out[0], out[1] - 0.010), style.frame, "-c -a +a")


def _add_door(wall: Wall, along: Interval, top: float, style: Style) -> None:
    """A door with a light above it, two rows of panels and a step before it."""
    deep, leaf = 0.22, 2.15
    wall.opening(along, (0.0, top), deep, style.trim, is_door=True)
    wall.panel(along, (0.0, leaf), -deep, style.door)
    wall.panel(along, (leaf, top), -deep, GLASS)
    wall.box(along, (leaf, leaf + 0.09), (-deep, -deep + 0.07), style.door, "-c -a +a")
    middle = (along[0] + along[1]) / 2
    for left, right in ((along[0] + 0.1, middle - 0.06), (middle + 0.06, along[1] - 0.1)):
        for low, high in ((0.3, 0.95), (1.1, 2.0)):
            wall.box((left, right), (low, high), (-deep, -deep + 0.03), style.door)
    wall.box((along[0] - POST, along[1] + POST), (0.0, 0.14), (0.0, 0.5), style.trim, "-c -b")
    for start, end in ((along[0] - POST, along[0]), (along[1], along[1] + POST)):
        wall.box((start, end), (0.14, top), (0.0, 0.09), style.trim, "-c -b")
    wall.box((along[0] - 0.25, along[1] + 0.25), (top, top + 0.25), (0.0, 0.13), style.trim)


def _add_balcony(wall: Wall, along: Interval, floor: float, style: Style) -> None:
    """A slab with a railing of upright bars."""
    out = 0.85
    wall.box(along, (floor, floor + 0.14), (0.0, out), style.trim)
    rail = (floor + 1.02, floor + 1.07)
    wall.box(along, rail, (out - 0.05, out), IRON, "")
    for start in (along[0], along[1] - 0.05):
        wall.box((start, start + 0.05), rail, (0.0, out - 0.05), IRON, "-c +c")
    count = int((along[1] - along[0]) / 0.2)
    for index in range(count + 1):
        start = along[0] + (along[1] - along[0] - 0.03) * index / count
        wall.box((start, start + 0.03), (floor + 0.14, rail[0]), (out - 0.04, out - 0.01), IRON, "-b +b")
    for start in (along[0], along[1] - 0.03):
        for index in range(1, 4):
            deep = (out - 0.1) * index / 4
            wall.box((start, start + 0.03), (floor + 0.14, rail[0]), (deep, deep + 0.03), IRON, "-b +b")
