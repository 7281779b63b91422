"""The page of a batch, `index.html`: every photo with its lines, figures and files; one file that needs no network."""

import base64
import statistics
import urllib.parse
from collections.abc import Iterable, Iterator
from html import escape
from pathlib import Path

from linecad.batch.job import THUMBNAILS, Figures
from linecad.batch.record import Row
from linecad.io import html
from linecad.io.files import write_bytes_atomically

NAME = "index.html"
LARGEST_THUMBNAIL = 200_000  # bytes; ours take about a tenth of it
STYLE = """\
body { margin: 2rem; background: #f7f7f8; }
main { display: grid; grid-template-columns: repeat(auto-fill, minmax(22rem, 1fr)); gap: 1rem; }
article { background: #fff; border: 1px solid #ddd; border-radius: 6px; padding: .8rem; overflow-wrap: anywhere; }
article.bad { border-color: #c33; }
img { width: 100%; height: auto; display: block; background: #eee; }
h2 { font-size: 1rem; margin: .5rem 0 .2rem; }
p { margin: .2rem 0; } .quiet { font-size: .85rem; }
"""


def write_page(folder: Path, rows: tuple[Row, ...]) -> None:
    """Write the page of these rows into the output folder. Raises OutputError."""
    text = html.page("linecad batch", STYLE, _body(folder, rows))
    write_bytes_atomically(folder / NAME, text.encode("utf-8", "replace"))  # names may hold lone surrogates


def _body(folder: Path, rows: tuple[Row, ...]) -> Iterator[str]:
    yield f"<h1>linecad batch</h1>\n<p>{escape(_summary(rows))}</p>\n<main>"
    for row in rows:
        yield from _article(folder, row)
    yield "</main>"


def _summary(rows: tuple[Row, ...]) -> str:
    done = [row.outcome.figures for row in rows if row.outcome.status == "done" and row.outcome.figures]
    text = f"{len(rows)} photos, {len(done)} done, {len(rows) - sum(r.outcome.status == 'done' for r in rows)} failed"
    if done:
        text += f"; in the median {statistics.median(figures.lines for figures in done):g} lines"
    return text


def _article(folder: Path, row: Row) -> Iterator[str]:
    outcome = row.outcome
    yield f'<article class="{"good" if outcome.status == "done" else "bad"}">'
    picture = _picture(folder, row)
    if picture:
        shown = "the photo, and its lines" if outcome.figures else "the photo"
        yield f'<img src="data:image/jpeg;base64,{picture}" alt="{shown}" loading="lazy">'
    yield f"<h2>{escape(Path(row.photo).name)}</h2>"
    if row.depth:
        yield f'<p class="quiet">depth map: {escape(_short(row.depth, row.photo))}</p>'
    if outcome.figures:
        yield f"<p>{escape(figures_text(outcome.figures))}</p>"
    if outcome.error:
        yield f'<p class="error">{escape(outcome.status)}: {escape(outcome.error)}</p>'
    yield f'<p class="quiet">{outcome.seconds:.1f} s, {outcome.memory_mb:.0f} MiB, {escape(row.finished)}</p>'
    files = [file for file in outcome.files if not file.startswith(f"{THUMBNAILS}/")]
    if files:
        yield f"<p>{_links(files)}</p>"
    yield "</article>"


def _short(depth: str, photo: str) -> str:
    """A map's name as seen from the folder of its photo."""
    path, folder = Path(depth), Path(photo).parent
    return str(path.relative_to(folder) if path.is_relative_to(folder) else path)


def figures_text(figures: Figures) -> str:
    """The figures of a scene in one line."""
    gap = "no bound" if figures.gap is None else f"gap {figures.gap:.2%}"
    camera = "" if figures.camera is None else f", camera {figures.camera}"
    return (
        f"{figures.lines} lines, {figures.real} of {figures.crossings} crossings real, {figures.planes} planes, "
        f"{figures.faces} faces; {figures.solver}, {gap}{camera}"
    )


def _links(files: Iterable[str]) -> str:
    # "./" first: a name with a colon in it is not the address of anything.
    return " ".join(
        f'<a href="./{urllib.parse.quote(file, errors="replace")}">{escape(Path(file).suffix or file)}</a>'
        for file in files
    )


def _picture(folder: Path, row: Row) -> str:
    """The small picture of a photo in base64; empty where there is none."""
    name = f"{THUMBNAILS}/{row.name}.jpg"
    if name not in row.outcome.files:
        return ""
    path = folder / name
    try:
        if path.stat().st_size > LARGEST_THUMBNAIL:
            return ""
        return base64.b64encode(path.read_bytes()).decode("ascii")
    except OSError:
        return ""
