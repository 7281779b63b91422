"""A scene to files, each in the format that its suffix chooses, with the photo where a format shows it."""

import os
import shlex
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import exporters.formats
from exporters.format_options import TEXTURES, UNDERLAY
from exporters.formats import SCENE_FILE, Format, find_format, options_for
from exporters.options import Value
from linecad.errors import LinecadError, OutputError, UnwrittenError
from linecad.io.files import check_output
from linecad.io.scene_file import write_scene
from linecad.scene import Scene

if TYPE_CHECKING:
    from linecad.camera.photo import Photo


@dataclass(frozen=True)
class PhotoOfScene:
    """Where to look for the photo of a scene."""

    named: Path | None = None  # by the user; it must be right
    camera: Path | None = None  # its calibration, if the scene was made with one
    scene_file: Path | None = None  # beside which it may lie


def export(
    scene: Scene,
    path: Path | str,
    photo: Path | str | None = None,
    camera: Path | str | None = None,
    **options: Value,
) -> None:
    """Write a scene to a file: the suffix of `path` chooses the format, .json the scene file.

    `photo` is the scene's photo, for formats that show it, and `camera` its calibration if the scene was made with one.
    Without a photo faces have no textures, and a warning says so. `options` are those of the format
    (`linecad options` lists them), hyphens as underscores: `texture_size=1024`. Raises OutputError where the file
    cannot be written or an option is not accepted, and PhotoError or CameraError where the photo is not the scene's.
    """
    path = Path(path)
    values = format_values([path], [f"{key.replace('_', '-')}={_text(value)}" for key, value in options.items()])
    check_output(path)
    where = PhotoOfScene(None if photo is None else Path(photo), None if camera is None else Path(camera))
    notes: list[str] = []
    pixels = pixels_for(scene, [path], values, where, notes.append)
    for note in notes:
        warnings.warn(note, stacklevel=2)
    write_outputs(scene, pixels, [path], values)


def format_values(outputs: Iterable[Path], texts: Iterable[str]) -> dict[str, Value]:
    """The values of the formats' options in texts KEY=VALUE, by key.

    Raises OutputError for an unknown suffix, a value that is not accepted, or a key that none of the formats has.
    """
    return options_for([path for path in outputs if not _is_scene_file(path)], texts)


def write_outputs(
    scene: Scene,
    pixels: NDArray[np.uint8] | None,
    outputs: Sequence[Path],
    values: Mapping[str, Value],
    on_stage: Callable[[str], None] | None = None,
    format_of: Callable[[Path], Format] = find_format,
) -> None:
    """Write a scene, each file whole or not at all: the scene file first, and what can be written beside what cannot.

    `pixels` (H, W, 3) RGB are those of its photo, for formats that show it; `values` are options of formats as
    `format_values` reads them. Raises UnwrittenError, with the text of the first that failed.
    """
    failed: dict[Path, OutputError] = {}
    for path in sorted(outputs, key=lambda path: not _is_scene_file(path)):
        if on_stage is not None:
            on_stage(f"writing {path}")
        try:
            if _is_scene_file(path):
                write_scene(scene, path)
            else:
                exporters.formats.export(scene, path, pixels, values, format_of(path))
        except OutputError as error:
            failed[path] = error
    if failed:
        first = next(iter(failed.values()))
        others = f" ({len(failed) - 1} more were not written)" if len(failed) > 1 else ""
        raise UnwrittenError(f"{first}{others}", tuple(failed)) from first


def keep_scene(scene: Scene, outputs: Sequence[Path]) -> Path:
    """Write the scene file of a scene whose `outputs` could not all be written, and return its path.

    It is the one among them, else it lies beside the first output whose folder takes it, else in the current folder,
    under a name that no file has. Raises the OutputError of the first of these places where none takes it.
    """
    named = [path for path in outputs if _is_scene_file(path)]
    beside = [_free_name(path) for path in [*outputs, Path(outputs[0].name)]]
    errors: list[OutputError] = []
    for path in dict.fromkeys([*named, *beside]):
        try:
            write_scene(scene, path)
        except OutputError as error:
            errors.append(error)
        else:
            return path
    raise errors[0]


def _free_name(output: Path) -> Path:
    suffixes = chain([SCENE_FILE], (f".{number}{SCENE_FILE}" for number in count(2)))
    return next(path for path in map(output.with_suffix, suffixes) if not os.path.lexists(path))


def export_command(
    scene_file: Path, photo: Path, more: Sequence[str], outputs: Sequence[Path], values: Mapping[str, Value]
) -> str:
    """The command that writes `outputs` of a scene file, with the options of their formats; `more` are arguments."""
    beside = scene_file.parent / photo.name
    given = [] if beside.exists() and beside.samefile(photo) else ["--photo", str(photo)]
    keys = {option.key for path in outputs if not _is_scene_file(path) for option in find_format(path).options}
    options = [f"--option {key}={_text(value)}" for key, value in values.items() if key in keys]
    written = [word for path in outputs for word in ("-o", str(path))]
    return " ".join([shlex.join(["linecad", "export", str(scene_file), *given]), *more, *options, shlex.join(written)])


def pixels_for(
    scene: Scene,
    outputs: Sequence[Path],
    values: Mapping[str, Value],
    photo: PhotoOfScene,
    on_note: Callable[[str], None],
    format_of: Callable[[Path], Format] = find_format,
) -> NDArray[np.uint8] | None:
    """(H, W, 3) RGB of the scene's photo if an output shows it; None where none does, or it is not found.

    Textures do without the photo, and `on_note` is told, unless they were asked for. Raises PhotoError or CameraError
    where the photo cannot be used, OutputError where textures were asked for and there is none.
    """
    formats = [format_of(path) for path in outputs if not _is_scene_file(path)]
    switch = TEXTURES[0]
    able = bool(scene.faces) and any(switch in row.options for row in formats)
    beneath = values.get(UNDERLAY.key, UNDERLAY.default) is True and any(UNDERLAY in row.options for row in formats)
    drawn = beneath or any(row.shows_photo and UNDERLAY not in row.options for row in formats)
    textured = able and values.get(switch.key, switch.default) is True
    if not drawn and not textured:
        return None
    asked = able and values.get(switch.key) is True
    try:
        found = _read(scene, photo)
    except LinecadError as error:
        if drawn or asked or photo.named is not None:
            raise
        on_note(f"{error}; the faces have no textures")
        return None
    if found is None and textured:
        missing = _missing(scene, photo)
        if asked:
            raise OutputError(f"textures were asked for, but {missing}")
        on_note(f"{missing}; the faces have no textures")
    if found is None and beneath:
        on_note(f"{_missing(scene, photo)}; no photo lies beneath the drawing")
    return None if found is None else found.pixels


def _read(scene: Scene, photo: PhotoOfScene) -> "Photo | None":
    """The photo as named, else beside the scene file, else none."""
    from linecad.camera.reread import find_beside, reread_photo  # loads what decodes photos

    path = photo.named
    if path is None and photo.scene_file is not None:
        path = find_beside(scene.photo, photo.scene_file)
    return None if path is None else reread_photo(path, scene.photo, scene.camera, photo.camera)


def _missing(scene: Scene, photo: PhotoOfScene) -> str:
    from exporters.model import photo_name

    name = photo_name(scene)
    if photo.scene_file is None:
        return f"the photo {name!r} was not given"
    return f"the photo {name!r} is not beside {photo.scene_file}; name it with --photo"


def _is_scene_file(path: Path) -> bool:
    return path.suffix.lower() == SCENE_FILE


def _text(value: Value) -> str:
    """A value as it stands behind KEY=."""
    return ("on" if value else "off") if isinstance(value, bool) else str(value)
