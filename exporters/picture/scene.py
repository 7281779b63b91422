"""PNG: the photo with its lines and faces coloured by axis and its crossings, beside three views of them in space."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exporters.bands import BANDS, LEAST, LIKELY, SURE, bands_of
from exporters.colours import line_colour
from exporters.model import Model, photo_name
from exporters.picture.canvas import Canvas, drawable, text_width
from exporters.picture.faces import OPACITY, draw_faces, draw_line, words_of
from exporters.picture.ids import draw_ids
from exporters.picture.views import VIEWS, draw_view
from linecad.arrays import Float
from linecad.directions import MAIN, axis_name, count_of
from linecad.scene import DepthMapReport, Lines, Scene

_WIDTH = 2400  # px
_MARGIN, _GAP = 44, 24  # px
_TOP, _ROW = _MARGIN + 122, 42  # px: where photo and views begin, and how much lower for one more line of facts
_PHOTO_WIDTH, _PHOTO_HEIGHT = 1560, 1500  # px, at most, with the views beside it
_VIEW_HEIGHT, _VIEW_HEIGHT_BELOW = 300, 560  # px, at least with the views beside the photo; always with them below
_PANORAMA = 1.9  # from this ratio of width to height on, the views stand below the photo
_LONGEST_PANORAMA = 40  # px of height that the thinnest strip of a photo still gets

_PAPER, _INK, _QUIET = (0.965, 0.965, 0.97), (0.13, 0.13, 0.15), (0.40, 0.40, 0.43)
_NO_PHOTO = (0.86, 0.86, 0.87)
_REAL, _FAKE, _CASING = (1.0, 0.84, 0.12), (0.80, 0.05, 0.62), (1.0, 1.0, 1.0)
_BY_MAP = (1.0, 0.50, 0.0)  # rim about the casing of lines that the depth map alone places
_TITLE, _TEXT = 42, 27  # px of text

_LINE_WIDTH, _THIN_LINE_WIDTH = {True: 5, False: 2}, {True: 4, False: 2}  # px, by boundary
_CASING_WIDTH, _THIN_CASING_WIDTH = 3, 1  # px that the casing of a line is wider than the line
_APART = 34  # px between entries of the legend
_RIM_WIDTH = 5  # px that the rim of a line is wider than its casing
_FEW_LINES = 600  # from there on they are drawn thin
_MARK_RADIUS, _SMALLEST_MARK = 7.0, 3.0  # px, of crossings
_OUTLINED = 1.22  # radius of a disc with its dark outline over that of the disc
_MEANING = {SURE: f"sure ({LEAST[SURE]:g})", LIKELY: f"likely ({LEAST[LIKELY]:g})"}  # in the legend
_FEW_MARKS = 400  # crossings; from there on they are drawn smaller, so that they do not cover the photo


class _Box(NamedTuple):
    left: int
    top: int
    width: int
    height: int


def write(model: Model, path: Path, photo: NDArray[np.uint8] | None, ids: bool = False) -> None:
    """Write the picture to `path`; OSError where that fails. `photo` is RGB, of the size of the camera, or None.

    With `ids` lines have their ids written onto them in place of the marks of their crossings.
    """
    scene = model.scene
    top = _TOP if scene.depth_map is None else _TOP + _ROW
    shape, views, height = _layout(scene.camera.width / scene.camera.height, top)
    legend = _legend(words_of(scene.lines)[1], count_of(scene.turns), marks=not ids)
    canvas = Canvas(_WIDTH, height + _ROW * (len(legend) - 1), _PAPER)
    named = _draw_photo(canvas.window(*shape), scene, photo, ids)
    _draw_title(canvas, scene, f"ids of {named} of {_count(len(scene.lines), 'line')}" if ids else "")
    if scene.depth_map is not None:
        _draw_depth_map(canvas, scene.depth_map, scene.lines)
    for box, (name, right, up) in zip(views, VIEWS, strict=True):
        draw_view(canvas.window(*box), scene, name, right, up)
    _draw_legend(canvas, legend)
    canvas.image().save(path, format="PNG")


def _layout(aspect: float, top: int) -> tuple[_Box, list[_Box], int]:
    """Where the photo and the views stand, from `top` down, and the height of the picture."""
    inner = _WIDTH - 2 * _MARGIN
    if aspect >= _PANORAMA:
        photo = _Box(_MARGIN, top, inner, max(round(inner / aspect), _LONGEST_PANORAMA))
        width, height = (inner - 2 * _GAP) // 3, _VIEW_HEIGHT_BELOW
        below = photo.top + photo.height + _GAP
        views = [_Box(_MARGIN + number * (width + _GAP), below, width, height) for number in range(3)]
        return photo, views, below + height + 96
    width = round(min(_PHOTO_WIDTH, _PHOTO_HEIGHT * aspect))
    photo = _Box(_MARGIN, top, max(width, 1), round(width / aspect))
    height = max(_VIEW_HEIGHT, (photo.height - 2 * _GAP) // 3)
    left = _MARGIN + photo.width + _GAP
    views = [_Box(left, top + number * (height + _GAP), _WIDTH - _MARGIN - left, height) for number in range(3)]
    return photo, views, top + max(photo.height, 3 * height + 2 * _GAP) + 96


def _draw_title(canvas: Canvas, scene: Scene, more: str = "") -> None:
    """What the picture shows, and `more` of it where that is not empty."""
    lines, real = scene.lines, int(scene.intersections.real.sum())
    title = (
        f"{drawable(photo_name(scene))}: {_count(len(lines), 'line')} "
        f"({_count(int(lines.is_boundary.sum()), 'boundary', 'boundaries')}), {_count(len(scene.planes), 'plane')}, "
        f"{_count(len(scene.faces), 'face')}"
    )
    canvas.text(_MARGIN, _MARGIN + 38, title, _TITLE, _INK)
    solve = scene.solve
    share = f"{100 * solve.gap:.3g} %" if np.isfinite(solve.gap) else "unknown"
    facts = [
        ", ".join(
            f"{int((lines.axis == axis).sum())} along {axis_name(axis)}" for axis in range(count_of(scene.turns))
        ),
        f"{_count(len(scene.intersections), 'crossing')}: {real} real, {len(scene.intersections) - real} fake",
        f"{solve.solver}, {solve.formulation}: {solve.status}, gap {share}",
        f"focal length {scene.camera.focal:.0f} px ({scene.camera.source})",
    ]
    facts += [*_sureness(lines), *([more] if more else [])]
    _draw_facts(canvas, _MARGIN, _MARGIN + 88, facts)


def _draw_depth_map(canvas: Canvas, report: DepthMapReport, lines: Lines) -> None:
    """What became of the depth map, and how many lines have the mark that it placed them."""
    x, y = _MARGIN, _MARGIN + 88 + _ROW
    facts = [report.text]
    if not report.left_out:
        facts.insert(0, f"{_count(int(np.sum(lines.by_depth_map)), 'line')} placed by the depth map")
        middle = y - _TEXT // 3
        width = _LINE_WIDTH[False] + _CASING_WIDTH
        for colour, wider in ((_BY_MAP, _RIM_WIDTH), (_CASING, 0), (_QUIET, -_CASING_WIDTH)):
            canvas.line((x + 6, middle), (x + 62, middle), colour, width + wider)
        x += 80
    _draw_facts(canvas, x, y, facts)


def _draw_facts(canvas: Canvas, x: int, y: int, facts: Sequence[str]) -> None:
    """One line of facts from `x`, written smaller where it would be cut off at the border of the picture."""
    text = "   ·   ".join(map(drawable, facts))
    size = min(_TEXT, int(_TEXT * (canvas.width - _MARGIN - x) / text_width(text, _TEXT)))
    canvas.text(x, y, text, size, _QUIET)


def _sureness(lines: Lines) -> list[str]:
    """How many lines are how sure, and how that is drawn."""
    bands = bands_of(lines)
    if bands is None:
        weak = int((lines.confidence == "weak").sum())
        return [f"{_count(weak, 'line')} weak: dashed, pale"] if weak else []
    counts = [f"{int((bands == band).sum())} {band}" for band in BANDS]
    return [f"depths right within 5 %: {', '.join(counts)}"]


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number} {one if number == 1 else many or one + 's'}"


def _draw_photo(panel: Canvas, scene: Scene, photo: NDArray[np.uint8] | None, ids: bool = False) -> int:
    """Draw the photo with the scene on it, and return how many lines have their ids there."""
    if photo is None:
        panel.fill(_NO_PHOTO)
    else:
        panel.show(photo)
    scale = np.array([panel.width / scene.camera.width, panel.height / scene.camera.height])

    def shown(pixels: Float) -> Float:
        result: Float = (pixels + 0.5) * scale - 0.5
        return result

    draw_faces(panel, scene, scale)
    _draw_segments(panel, scene, shown(scene.lines.segment))
    if photo is None:
        panel.text(panel.width / 2, 24, "photo not given", _TEXT, _QUIET, "ma")
    if ids:
        return draw_ids(panel, scene, shown(scene.lines.segment))
    _draw_crossings(panel, scene, shown(scene.intersections.pixel))
    return 0


def _draw_segments(panel: Canvas, scene: Scene, ends: Float) -> None:
    """Boundaries over the others, with a light casing that keeps them apart from the photo; some with a rim."""
    lines = scene.lines
    words, _ = words_of(lines)
    few = len(lines) <= _FEW_LINES
    widths, casing = (_LINE_WIDTH, _CASING_WIDTH) if few else (_THIN_LINE_WIDTH, _THIN_CASING_WIDTH)
    for wanted in (False, True):
        chosen = np.flatnonzero(lines.is_boundary == wanted).tolist()
        width = widths[wanted]
        for number in (number for number in chosen if lines.by_depth_map[number]):
            panel.line(ends[number, 0].tolist(), ends[number, 1].tolist(), _BY_MAP, width + casing + _RIM_WIDTH)
        for number in chosen:
            panel.line(ends[number, 0].tolist(), ends[number, 1].tolist(), _CASING, width + casing)
        for number in chosen:
            colour = line_colour(int(lines.axis[number]), True)
            draw_line(panel, ends[number].tolist(), words[number], colour, width)


def _draw_crossings(panel: Canvas, scene: Scene, centres: Float) -> None:
    """Real ones over the others."""
    count = max(len(centres), _FEW_MARKS)
    radius = max(_MARK_RADIUS * (_FEW_MARKS / count) ** 0.5, _SMALLEST_MARK)
    real = scene.intersections.real
    for centre in centres[~real].tolist():
        _draw_fake(panel, centre, radius)
    for centre in centres[real].tolist():
        _draw_real(panel, centre, radius)


def _draw_real(panel: Canvas, centre: list[float], radius: float) -> None:
    panel.disc(centre, _OUTLINED * radius, _INK)
    panel.disc(centre, radius, _REAL)


def _draw_fake(panel: Canvas, centre: list[float], radius: float) -> None:
    panel.cross(centre, radius + 2, _CASING, 5)
    panel.cross(centre, radius + 1.5, _FAKE, 3)


@dataclass(frozen=True)
class _Entry:
    """One sample of the legend with its label, from `x`, the middle of its row."""

    label: str
    indent: int  # px from the start of the sample to that of the label
    after: int  # px from the end of the label to the next entry
    draw: Callable[[Canvas, float, float], None]  # the sample

    @property
    def width(self) -> float:
        """From the start of the sample to the end of the label, px."""
        return self.indent + text_width(self.label, _TEXT)


def _legend(words: Sequence[str], directions: int, marks: bool = True) -> list[list[_Entry]]:
    """The entries of the legend, row by row, so that each row fits the picture."""
    rows: list[list[_Entry]] = [[]]
    left = float(_MARGIN)
    for entry in _entries(words, directions, marks):
        if rows[-1] and left + entry.width > _WIDTH - _MARGIN:
            rows.append([])
            left = float(_MARGIN)
        rows[-1].append(entry)
        left += entry.width + entry.after
    return rows


def _entries(words: Sequence[str], directions: int, marks: bool) -> list[_Entry]:
    """The legend of lines, of the marks of crossings where these are drawn, and of how sure depths are."""

    def line(axis: int, length: int, is_boundary: bool) -> Callable[[Canvas, float, float], None]:
        colour, width = line_colour(axis, True), _LINE_WIDTH[is_boundary]
        return lambda canvas, x, y: canvas.line((x, y), (x + length, y), colour, width)

    entries = [
        _Entry(f"{axis_name(axis)} {'boundary' if is_boundary else 'other'}", 62, _APART, line(axis, 50, is_boundary))
        for axis in range(MAIN)
        for is_boundary in (True, False)
    ]
    # Short, for there may be many.
    entries += [_Entry(axis_name(axis), 28, 20, line(axis, 20, True)) for axis in range(MAIN, directions)]
    crossings = [
        _Entry("real crossing", 26, _APART, lambda canvas, x, y: _draw_real(canvas, [x + 8, y], _MARK_RADIUS)),
        _Entry("fake crossing", 26, _APART, lambda canvas, x, y: _draw_fake(canvas, [x + 8, y], _MARK_RADIUS)),
    ]
    entries += crossings if marks else []
    for word in words:
        entries.append(_Entry(_MEANING.get(word, word), 70 if word in LEAST else 46, _APART, partial(_draw_word, word)))
    return entries


def _draw_word(word: str, canvas: Canvas, x: float, y: float) -> None:
    canvas.tint([[_swatch(x, y)]], _INK, 2 * OPACITY[word])
    if word in LEAST:
        draw_line(canvas, ([x, y], [x + 60, y]), word, _INK, 3)


def _draw_legend(canvas: Canvas, rows: list[list[_Entry]]) -> None:
    for number, entries in enumerate(rows):
        x, y = float(_MARGIN), canvas.height - 48 - _ROW * (len(rows) - 1 - number)
        for entry in entries:
            entry.draw(canvas, x, y)
            canvas.text(x + entry.indent, y, entry.label, _TEXT, _INK, "lm")
            x = x + entry.indent + text_width(entry.label, _TEXT) + entry.after


def _swatch(x: float, y: float) -> Float:
    """The sample of a face in the legend."""
    return np.array([[x, y - 13], [x + 36, y - 13], [x + 36, y + 13], [x, y + 13]])
