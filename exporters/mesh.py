"""Meshes by trimesh, in metres, z up: OBJ (faces and lines), PLY and STL (faces only).

OBJ: https://paulbourke.net/dataformats/obj/  PLY: https://paulbourke.net/dataformats/ply/
STL: https://www.loc.gov/preservation/digital/formats/fdd/fdd000505.shtml

None of the three has a field for the unit, so a comment says it; programs that count in millimetres, such as FreeCAD,
read a metre as a millimetre.
"""

from pathlib import Path

import numpy as np
import trimesh
from trimesh.exchange.obj import export_obj
from trimesh.exchange.ply import export_ply
from trimesh.exchange.stl import export_stl

from exporters.faces import triangulate
from exporters.model import LineGroup, Model, build_model
from linecad.errors import OutputError
from linecad.scene import Scene

_PLY_FORMAT_LINE = b"format binary_little_endian 1.0\n"  # comments may follow it
_STL_HEADER = 80  # bytes of free text; it must not begin with "solid", by which readers know STL in text form


def write(scene: Scene, path: Path) -> None:
    """Write .obj, .ply or .stl, by the suffix of `path`.

    Raises OSError where that fails, and OutputError for a scene without faces in a format that holds nothing else.
    """
    model = build_model(scene)
    if path.suffix == ".obj":
        path.write_text(_obj(model), encoding="utf-8", newline="\n")
        return
    if not model.faces:
        raise OutputError(f"{path.suffix} holds faces only and the scene has none; use .obj, .glb or another format")
    comment = f"linecad, z up; {model.unit_note}"
    path.write_bytes(_ply(model, comment) if path.suffix == ".ply" else _stl(model, comment))


def _meshes(model: Model) -> list[trimesh.Trimesh]:
    """One mesh a face; vertices are neither merged nor reordered."""
    return [
        trimesh.Trimesh(face.vertices, triangulate(face), process=False, metadata={"name": face.name})
        for face in model.faces
    ]


def _ply(model: Model, comment: str) -> bytes:
    data: bytes = export_ply(trimesh.util.concatenate(_meshes(model)), vertex_normal=False, include_attributes=False)
    return data.replace(_PLY_FORMAT_LINE, _PLY_FORMAT_LINE + f"comment {comment}\n".encode(), 1)


def _stl(model: Model, comment: str) -> bytes:
    data = export_stl(trimesh.util.concatenate(_meshes(model)))
    return comment.encode().ljust(_STL_HEADER)[:_STL_HEADER] + data[_STL_HEADER:]


def _obj(model: Model) -> str:
    header = f"linecad: reconstruction of {model.photo}, z up; {model.unit_note}"
    parts = [f"# {header}\n"]
    if model.faces:
        parts = [export_obj(trimesh.Scene(_meshes(model)), include_normals=False, include_texture=False, header=header)]
    first = 1 + sum(len(face.vertices) for face in model.faces)  # OBJ counts vertices from 1, through all objects
    for group in model.groups:
        parts.append(_obj_lines(group, first))
        first += 2 * len(group.ids)
    return "\n".join(part.strip() for part in parts) + "\n"


def _obj_lines(group: LineGroup, first: int) -> str:
    """A group as an object of two-point lines; the comment above each line gives its id."""
    rows = [f"o {group.name}"]
    rows += [f"v {x:.8f} {y:.8f} {z:.8f}" for x, y, z in group.ends.reshape(-1, 3).tolist()]
    starts = np.arange(first, first + 2 * len(group.ids), 2).tolist()
    for number, start in zip(group.ids.tolist(), starts, strict=True):
        rows += [f"# line {number}", f"l {start} {start + 1}"]
    return "\n".join(rows)
