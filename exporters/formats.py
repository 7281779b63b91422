"""The formats that a scene can be written in, and the one function that writes them all.

To add a format, write one module with `write(model, path)` and give it a row in FORMATS; nothing else names it. What a
user can choose about a format stands in its row; `write` takes it by keyword, but for MODEL_OPTIONS, by which the model
is made. A format with textures has TEXTURES among its options, and its `write` takes what is made of them as
`textures`. Where other files may lie beside the export, the
row says which; `write` takes their names as `names` and returns the files as `SideFiles`, which are written for it.
"""

import importlib
import importlib.util
import threading
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exporters.beside import NOTHING, Beside, write_with_side_files
from exporters.format_options import (
    DPI,
    IDS,
    INSTANCES,
    MODEL_OPTIONS,
    ORIGIN,
    SEWN,
    SHEET,
    TEXTURES,
    THICKNESS,
    TUBES,
    UNDERLAY,
    UP,
    VERSION,
)
from exporters.model import build_model
from exporters.options import Option, Value, read_options
from exporters.textures.pages import PAGE_NAME, Textures
from linecad.errors import OutputError
from linecad.io.files import check_output, write_atomically
from linecad.scene import Camera, Scene

SCENE_FILE = ".json"  # written by linecad.io.scene_file; named here only to tell the user


# ezdxf and OCCT have settings for the whole process, which a second thread would change under the first.
_ONE_AT_A_TIME = threading.Lock()


class Extra(NamedTuple):
    """An extra of linecad that not everybody has."""

    name: str  # in pyproject.toml
    library: str  # the module that it brings


class Format(NamedTuple):
    """A row of the table of formats."""

    module: str  # imported only when the format is written: its libraries take up to seconds to load
    phrase: str  # what the file holds, for people
    unit: str  # of the lengths in the file
    shows_photo: bool = False  # its `write` also takes the photo
    needs_photo: bool = False  # and raises OutputError where it is None
    options: tuple[Option, ...] = ()  # its `write` takes each by keyword, but for MODEL_OPTIONS and TEXTURES
    beside: Beside = NOTHING  # the files that may lie beside an export; where there are any, `write` also takes `names`
    extra: Extra | None = None  # what must be installed for it beside linecad


_PAGES = Beside(folder=".textures", part=PAGE_NAME)
_PICTURE = Beside(folder=".pictures", part=PAGE_NAME)
_WORLD_FILE = Beside(library="w", keeps_name=True)  # `a.tifw`: that is how readers find it
_PAGES_AND_MATERIALS = Beside(folder=".textures", part=PAGE_NAME, library=".mtl")

FORMATS: dict[str, Format] = {
    ".dxf": Format(
        "exporters.dxf", "lines on layers, faces and their outlines", "metres", options=(VERSION, *MODEL_OPTIONS)
    ),
    ".step": Format(
        "exporters.step.write",
        "lines and faces as named and coloured parts",
        "millimetres",
        options=(SEWN, INSTANCES, *MODEL_OPTIONS),
    ),
    ".ifc": Format(
        "exporters.ifc.write",
        "IFC 4: walls with windows and doors, storeys, ground, lines",
        "metres",
        options=(THICKNESS, *MODEL_OPTIONS),
        extra=Extra("ifc", "ifcopenshell"),
    ),
    ".3dm": Format(
        "exporters.rhino.write",
        "Rhino: lines as curves, faces as planar surfaces with holes",
        "metres",
        options=MODEL_OPTIONS,
        extra=Extra("rhino", "rhino3dm"),
    ),
    ".skp": Format(
        "exporters.skp",
        "SketchUp: lines and faces with holes in groups on layers",
        "inches",
        options=MODEL_OPTIONS,
        extra=Extra("sketchup", "openskp"),
    ),
    ".glb": Format(
        "exporters.gltf.write",
        "lines, faces, camera for viewers and Blender",
        "metres",
        options=(TUBES, INSTANCES, *MODEL_OPTIONS, *TEXTURES),
    ),
    ".usda": Format(
        "exporters.usd.write",
        "a USD stage as text: lines, faces, camera",
        "metres",
        options=(INSTANCES, *MODEL_OPTIONS, *TEXTURES),
        beside=_PAGES,
    ),
    ".usdc": Format(
        "exporters.usd.write",
        "a USD stage, compact: lines, faces, camera",
        "metres",
        options=(INSTANCES, *MODEL_OPTIONS, *TEXTURES),
        beside=_PAGES,
    ),
    ".usdz": Format(
        "exporters.usd.write",
        "a USD stage as a package: lines, faces, camera",
        "metres",
        options=(INSTANCES, *MODEL_OPTIONS, *TEXTURES),
    ),
    ".obj": Format(
        "exporters.obj",
        "faces as triangles, and lines",
        "metres",
        options=(UP, *MODEL_OPTIONS, *TEXTURES),
        beside=_PAGES_AND_MATERIALS,
    ),
    ".ply": Format("exporters.mesh", "faces as triangles", "metres", options=(ORIGIN,)),
    ".stl": Format("exporters.mesh", "faces as triangles", "metres", options=(ORIGIN,)),
    ".fspy": Format(
        "exporters.fspy.write",
        "the photo with its camera, to correct in fSpy",
        "metres",
        shows_photo=True,
        needs_photo=True,
        options=(ORIGIN,),
    ),
    ".png": Format(
        "exporters.picture.scene",
        "the photo with its lines, and three views of them in space",
        "pixels",
        shows_photo=True,
        options=(IDS,),
    ),
    ".elevation.svg": Format(
        "exporters.drawings.elevation",
        "a facade from the front, to scale, with dimensions",
        "millimetres",
        shows_photo=True,
        options=(*SHEET, DPI, UNDERLAY),
    ),
    ".elevation.pdf": Format(
        "exporters.drawings.elevation",
        "the elevation as a page to print",
        "millimetres",
        shows_photo=True,
        options=(*SHEET, DPI, UNDERLAY),
    ),
    ".elevation.dxf": Format(
        "exporters.drawings.elevation",
        "the elevation in metres, with its sheet in paper space",
        "metres",
        shows_photo=True,
        options=(*SHEET, DPI, UNDERLAY),
        beside=_PICTURE,
    ),
    ".elevation.tif": Format(
        "exporters.drawings.elevation",
        "the rectified photo of a facade, to scale",
        "pixels",
        shows_photo=True,
        needs_photo=True,
        options=(*SHEET, DPI),
        beside=_WORLD_FILE,
    ),
    ".plan.svg": Format(
        "exporters.drawings.plan", "walls from above and the camera, to scale", "millimetres", options=SHEET
    ),
    ".plan.pdf": Format("exporters.drawings.plan", "the plan as a page to print", "millimetres", options=SHEET),
    ".plan.dxf": Format(
        "exporters.drawings.plan", "the plan in metres, with its sheet in paper space", "metres", options=SHEET
    ),
}


def suffixes() -> tuple[str, ...]:
    """The suffixes of all formats, in lower case."""
    return tuple(FORMATS)


def suffix_of(path: Path) -> str:
    """The suffix that chooses the format, in lower case: the longest of FORMATS that the name ends with, or any."""
    name = path.name.lower()[1:]  # the name of a hidden file is no suffix
    return max((suffix for suffix in FORMATS if name.endswith(suffix)), key=len, default=path.suffix.lower())


def find_format(path: Path) -> Format:
    """The format that the suffix of `path` chooses, in upper or lower case; OutputError for an unknown one."""
    suffix = suffix_of(path)
    if suffix not in FORMATS:
        found = f"unknown suffix {suffix}" if suffix else "no suffix"
        known = f"{', '.join(FORMATS)}, or {SCENE_FILE} for the scene file"
        raise OutputError(f"{path.name}: {found}; use {known}")
    return FORMATS[suffix]


def drawing_format(path: Path, is_plan: bool) -> Format:
    """The format of a drawing by the last suffix of `path`.

    Raises OutputError where drawings have no such format, or where the name says the other kind of drawing, for
    `export` would write that one into it.
    """
    kind, suffix = ".plan" if is_plan else ".elevation", path.suffix.lower()
    if kind + suffix not in FORMATS:
        known = ", ".join(each.removeprefix(kind) for each in FORMATS if each.startswith(kind))
        found = f"unknown suffix {suffix}" if suffix else "no suffix"
        raise OutputError(f"{path.name}: {found} for {'a plan' if is_plan else 'an elevation'}; use {known}")
    stem = Path(path.stem)
    name = f"{stem.stem}{kind}{suffix}"
    if is_plan and stem.suffix.lower() == ".elevation":
        raise OutputError(
            f"{path.name}: the name says an elevation, --plan draws a plan; leave it out, or write {name}"
        )
    if not is_plan and stem.suffix.lower() == ".plan":
        raise OutputError(f"{path.name}: the name says a plan, which --plan draws; add it, or write {name}")
    return FORMATS[kind + suffix]


def options_for(paths: Iterable[Path], texts: Iterable[str]) -> dict[str, Value]:
    """The values of the options KEY=VALUE, by key, for `export` to all of `paths`.

    Raises OutputError for an unknown suffix, a value that is not accepted, a key that none of the formats has, and a
    format whose extra is not installed: told before any work is done.
    """
    formats = {suffix_of(path): find_format(path) for path in paths}
    for suffix, row in formats.items():
        _check_installed(suffix, row)
    return read_options(texts, {suffix: row.options for suffix, row in formats.items()})


def export(
    scene: Scene,
    path: Path,
    photo: NDArray[np.uint8] | None = None,
    options: Mapping[str, Value] | None = None,
    row: Format | None = None,
) -> None:
    """Write a scene in the format that the suffix of `path` chooses, or in that of `row`, whole or not at all.

    `photo` is RGB, (H, W, 3), of exactly the size of the scene's camera; formats that show the photo, or lay it on the
    faces, do without it where it is None. `options` has values by key, as `options_for` returns them; the format takes
    those of its own. What the format's row says lies beside `path` is written with it. Raises ValueError for a photo of
    another kind, and OutputError for an unknown suffix, an extra that is not installed, a place that cannot be written,
    a full disk, or a scene that holds nothing for this format.
    """
    chosen = find_format(path) if row is None else row
    given = {} if options is None else options
    arguments: dict[str, Any] = {option.name: given.get(option.key, option.default) for option in chosen.options}
    if chosen.shows_photo:
        arguments["photo"] = photo
    _check_photo(photo, scene.camera)
    if not len(scene.lines) and not scene.faces:
        raise OutputError(f"{path.name}: the scene holds neither lines nor faces; there is nothing to write")
    check_output(path)
    _check_installed(suffix_of(path), chosen)
    module = importlib.import_module(chosen.module)
    by_band, by_role, origin, by_component = (arguments.pop(option.name, option.default) for option in MODEL_OPTIONS)
    model = build_model(scene, by_band, by_role, origin, by_component)
    if TEXTURES[0] in chosen.options:
        on, size, fill = (arguments.pop(option.name) for option in TEXTURES)
        arguments["textures"] = _textures(scene, photo, size, fill) if on else None
    if chosen.beside != NOTHING:
        arguments["names"] = chosen.beside.names(path)

    def write(temporary: Path) -> Any:
        with _ONE_AT_A_TIME:
            return module.write(model, temporary, **arguments)

    if chosen.beside != NOTHING:
        write_with_side_files(path, chosen.beside, write)
    else:
        write_atomically(path, write)


def _check_installed(suffix: str, row: Format) -> None:
    if row.extra is not None and importlib.util.find_spec(row.extra.library) is None:
        name, library = row.extra
        raise OutputError(f"{suffix} files need {library}, which is not installed: pip install 'linecad[{name}]'")


class _Made(NamedTuple):
    scene: Scene
    photo: NDArray[np.uint8]
    size: int
    fill: str
    textures: Textures


_last_made: list[_Made] = []  # at most one: a scene goes to several formats, one after the other


def _textures(scene: Scene, photo: NDArray[np.uint8] | None, size: int, fill: str) -> Textures | None:
    """What of the photo lies on the faces; None where there is no photo or no face."""
    if photo is None or not scene.faces:
        return None
    for made in _last_made[:]:
        if made.scene is scene and made.photo is photo and (made.size, made.fill) == (size, fill):
            return made.textures
    from exporters.textures.build import build_textures

    textures = build_textures(scene, photo, size, fill)
    _last_made[:] = [] if photo.flags.writeable else [_Made(scene, photo, size, fill, textures)]  # that one may change
    return textures


def _check_photo(photo: NDArray[np.uint8] | None, camera: Camera) -> None:
    wanted = (camera.height, camera.width, 3)
    if photo is not None and (photo.shape != wanted or photo.dtype != np.uint8):
        raise ValueError(f"photo is {photo.dtype} of shape {photo.shape}, expected uint8 of shape {wanted}")
