"""A Scene as a file: JSON, described in docs/reference/scene-file.md, that reads back as exactly the same numbers."""

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import cast

from linecad.errors import OutputError, SceneFileError
from linecad.io.files import read_text, write_text_atomically
from linecad.io.scene_document import document_of
from linecad.io.scene_reading import scene_of
from linecad.io.strict_json import Node, parse
from linecad.scene import Scene

LARGEST_FILE = 256 * 2**20  # bytes; a scene of 2,000 lines takes about one hundredth of it


def read_scene(path: str | os.PathLike[str]) -> Scene:
    """The scene in a file; SceneFileError if it cannot be read or breaks a promise of docs/reference/scene-file.md."""
    text = read_text(path, LARGEST_FILE, "scene file", SceneFileError)
    try:
        return scene_from_json(text)
    except SceneFileError as error:
        raise SceneFileError(f"{' '.join(str(path).splitlines())}: {error}") from None


def write_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write the scene file, whole or not at all; OutputError when that cannot be done."""
    write_text_atomically(Path(path), scene_to_json(scene))


def scene_from_json(text: str) -> Scene:
    """The scene that a JSON text tells; SceneFileError with one line when it breaks docs/reference/scene-file.md."""
    try:
        return scene_of(parse(text))
    except ValueError as error:  # a JsonError, or a record that refuses its values
        raise SceneFileError(f"{error}; see docs/reference/scene-file.md") from None


def scene_to_json(scene: Scene) -> str:
    """The text of the scene file, the same for the same scene, with one record in each line.

    Raises OutputError for a scene that `scene_from_json` would refuse, so that no such file is ever written.
    """
    document = document_of(scene)
    try:
        scene_of(Node(document))
    except ValueError as error:  # a JsonError, or a record that refuses its values
        raise OutputError(f"the scene cannot be saved: {error}") from None
    parts = [f" {json.dumps(key)}: {_layout(key, value)}" for key, value in document.items()]
    text = "{\n" + ",\n".join(parts) + "\n}\n"
    # A file name that is not UTF-8 holds lone surrogates, which only an escape can carry.
    return text.encode("utf-8", "backslashreplace").decode()


def _layout(key: str, value: object) -> str:
    """A member of the top object, its records one in each line."""
    if key == "planes" and isinstance(value, list):
        return _rows([_plane_rows(plane) for plane in value], " ")
    if key in ("lines", "intersections", "openings", "notes") and isinstance(value, list):
        return _rows([_compact(record) for record in value], " ")
    return _compact(value)


def _plane_rows(plane: dict[str, object]) -> str:
    head = _compact({key: value for key, value in plane.items() if key != "faces"})
    faces = _rows([_compact(face) for face in cast(list[object], plane["faces"])], "  ")
    return f'{head[:-1]}, "faces": {faces}}}'


def _rows(rows: Iterable[str], indent: str) -> str:
    text = ",\n".join(f"{indent} {row}" for row in rows)
    return f"[\n{text}\n{indent}]" if text else "[]"


def _compact(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
