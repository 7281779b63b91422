"""Wavefront OBJ with its material library, in metres, y up: https://paulbourke.net/dataformats/obj/

OBJ has no field for what is up. Blender, three.js and Unity take y for it, so a scene with z up lies on its back there;
programs that take the numbers as they are, such as FreeCAD, get z by the option `up`.

OBJ has no field for the unit, so a comment says it; programs that count in millimetres, such as FreeCAD, read a metre
as a millimetre. A material has the name of its picture, which says what is in it: a library that holds the materials
of two versions of a file serves both.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from exporters.beside import NO_FILES, Names, SideFiles
from exporters.faces import FlatFace
from exporters.model import LineGroup, Model, in_component
from exporters.textures.pages import Textures
from exporters.triangulation import triangulate
from linecad.arrays import Float

Points = Callable[[Float], list[str]]  # (M, 3) m, z up: a row of the file each


def write(model: Model, path: Path, names: Names, up: str = "y", textures: Textures | None = None) -> SideFiles:
    """Write the model as OBJ to `path`; OSError where that fails. Its textures and their materials lie beside it."""
    turned = "y up: its x, y, z are x, z, -y of the scene" if up == "y" else "z up"
    rows = [f"# linecad: reconstruction of {model.photo}, {turned}; {model.unit_note}"]
    points = _points_y_up if up == "y" else _points
    if textures is not None and model.faces:
        rows.append(f"mtllib {names.library}")
    first = 1  # OBJ counts vertices from 1, through all objects
    parted = len(model.components) > 1
    for face in model.faces:
        rows += _group("faces", face.component) if parted else []
        rows += _face(face, first, points, textures, model.eye)
        first += len(face.vertices)
    for group in model.groups:
        rows += _group("lines", group.component) if parted else []
        rows += _lines(group, first, points)
        first += 2 * len(group.ids)
    path.write_text("\n".join(rows) + "\n", encoding="utf-8", newline="\n")
    return NO_FILES if textures is None else SideFiles(textures.files, _materials(textures, names.folder))


def _group(name: str, component: int) -> list[str]:
    """That what follows is of a component; it holds for one object, whose name the next row begins."""
    return [f"g {in_component(name, component)}"]


def _materials(textures: Textures, folder: str) -> str:
    """The text of an MTL file for pages in `folder` beside it."""
    rows = ["# linecad: the photo on the faces, as it is"]
    for page in textures.pages:
        rows += [f"newmtl {_material(page.name)}", "Ka 1 1 1", "Kd 1 1 1", "Ks 0 0 0", "illum 0"]
        rows += [f"map_Kd {folder}/{page.name}"]
    return "\n".join(rows) + "\n"


def _material(page_name: str) -> str:
    return Path(page_name).stem


def _face(face: FlatFace, first: int, points: Points, textures: Textures | None, eye: Float) -> list[str]:
    """A face as an object of triangles; the comment below its name says what it is, such as `wall 3`."""
    rows = [f"o {face.name}", f"# {face.label}", *points(face.vertices)]
    if textures is None:
        corner = "{0}"
    else:
        corner = "{0}/{0}"
        rows += [f"vt {s:.8f} {t:.8f}" for s, t in textures.coordinates(face, eye).tolist()]
        rows.append(f"usemtl {_material(textures.pages[textures.page(face)].name)}")
    rows += [
        "f " + " ".join(corner.format(number) for number in three) for three in (triangulate(face) + first).tolist()
    ]
    return rows


def _lines(group: LineGroup, first: int, points: Points) -> list[str]:
    """A group as an object of two-point lines; the comment above each line gives its id and its role."""
    rows = [f"o {group.name}", *points(group.ends.reshape(-1, 3))]
    starts = np.arange(first, first + 2 * len(group.ids), 2).tolist()
    for number, role, start in zip(group.ids.tolist(), group.roles.tolist(), starts, strict=True):
        rows += [f"# line {number} {role}", f"l {start} {start + 1}"]
    return rows


def _points(points: Float) -> list[str]:
    return [f"v {x:.8f} {y:.8f} {z:.8f}" for x, y, z in points.tolist()]


def _points_y_up(points: Float) -> list[str]:
    return _points(np.column_stack([points[:, 0], points[:, 2], -points[:, 1]]))
