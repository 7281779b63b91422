"""SKP, SketchUp 2017 and newer, in inches: https://github.com/iamahsanmehmood/openskp

Trimble publishes no specification; the library's author took the format apart. A group a group of lines, a face, or a
window or door with all its faces, each on a layer (a tag in newer versions) as in the other formats. Attributes named
`linecad` tell ids and what they are. Needs the extra `sketchup`.
"""

import contextlib
import itertools
import sys
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from openskp.create import ComponentDefinitionBuilder, SkpBuilder, SkpWriteError

from exporters.colours import RGB, face_colour, line_colour
from exporters.faces import FlatFace
from exporters.identity import identity_of
from exporters.model import LineGroup, Model, in_component
from exporters.triangulation import checked_polygon
from linecad.arrays import Float
from linecad.directions import axis_name
from linecad.errors import OutputError

_METRES_PER_INCH = 0.0254
_DICTIONARY = "linecad"  # of attributes
_LONGEST_TEXT = 255  # characters of an attribute
_LIBRARY = "openskp.create"


def write(model: Model, path: Path) -> None:
    """Write the model as SKP to `path`; OSError where that fails."""
    with _fixed_ids_and_times(identity_of(model.scene)):
        data: bytes = _Drawing(model).builder.to_bytes()
    path.write_bytes(data)


@contextlib.contextmanager
def _fixed_ids_and_times(identity: uuid.UUID) -> Iterator[None]:
    """Without the random ids and the clock that the library asks whenever it ends a group."""
    library: Any = sys.modules[_LIBRARY]
    count = itertools.count()
    before = library.uuid, library.time
    library.uuid = SimpleNamespace(uuid4=lambda: uuid.uuid5(identity, str(next(count))))
    library.time = SimpleNamespace(time=lambda: 0)
    try:
        yield
    finally:
        library.uuid, library.time = before


class _Drawing:
    """A SketchUp file of a model; the library wants materials and layers before all groups."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self.builder = SkpBuilder()
        kinds = sorted({face.kind for face in model.faces})
        self._materials = {kind: self.builder.add_material(kind, _bytes(face_colour(kind))) for kind in kinds}
        colours = {group.name: line_colour(group.axis, group.is_boundary) for group in model.groups}
        colours |= {_layer(face): face_colour(face.kind) for face in model.faces}
        self._layers = {name: self.builder.add_layer(name, _bytes(colour)) for name, colour in colours.items()}
        for group in model.groups:
            self._add_lines(group)
        for face in model.loose_faces:
            self._add_thing(face.label, _layer(face), [face])
        for fitting in model.fittings:
            self._add_thing(fitting.label, _layer(fitting.faces[0]), fitting.faces)

    def _add_lines(self, group: LineGroup) -> None:
        words: dict[str, object] = {
            "axis": axis_name(group.axis),
            "boundary": str(group.is_boundary).lower(),
            "ids": list(map(str, group.ids.tolist())),  # in the order of the edges
            "roles": group.roles.tolist(),
        }
        if len(group.probability):
            words["probabilities"] = group.probability.tolist()
        with self._group(group.name, group.name, words) as made:
            for ends in group.ends:
                made.add_polyline(_inches(ends))

    def _add_thing(self, label: str, layer: str, faces: Iterable[FlatFace]) -> None:
        faces = list(faces)
        opening = {} if faces[0].opening is None else {"opening": str(faces[0].opening)}
        with self._group(label, layer, opening) as made:
            for face in faces:
                self._add_face(made.add_face, face)

    def _add_face(self, add: Callable[..., None], face: FlatFace) -> None:
        checked_polygon(face)
        outline, *holes = map(_inches, face.rings)
        material = self._materials[face.kind]
        try:
            add(
                outline, material, back_material=material, holes=holes, attribute_dict_name=_DICTIONARY,
                attributes={"id": str(face.id), "face": face.name, "kind": face.kind, "plane": str(face.plane)},
            )  # fmt: skip
        except SkpWriteError as error:
            said = "is too small or too thin for SketchUp; correct it in the scene file"
            raise OutputError(f"{face.name} {said}") from error

    def _group(self, name: str, layer: str, words: Mapping[str, object]) -> ComponentDefinitionBuilder:
        told = {"unit": self._model.unit_note, "photo": self._model.photo[:_LONGEST_TEXT], **words}
        return self.builder.add_group(name, layer=self._layers[layer], attributes=told, attribute_dict_name=_DICTIONARY)


def _layer(face: FlatFace) -> str:
    return in_component(f"{'faces' if face.opening is None else 'openings'}_{face.kind}", face.component)


def _inches(points: Float) -> list[list[float]]:
    scaled: list[list[float]] = (points / _METRES_PER_INCH).tolist()
    return scaled


def _bytes(colour: RGB) -> tuple[int, ...]:
    return (*(round(255 * value) for value in colour), 255)
