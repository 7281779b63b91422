"""Meshes by trimesh, in metres, z up: PLY and STL, which hold faces only.

PLY: https://paulbourke.net/dataformats/ply/
STL: https://www.loc.gov/preservation/digital/formats/fdd/fdd000505.shtml

Neither has a field for the unit, so a comment says it; programs that count in millimetres, such as FreeCAD,
read a metre as a millimetre.
"""

from pathlib import Path

import trimesh
from trimesh.exchange.ply import export_ply
from trimesh.exchange.stl import export_stl

from exporters.model import Model
from exporters.triangulation import triangulate
from linecad.errors import OutputError

_PLY_FORMAT_LINE = b"format binary_little_endian 1.0\n"  # comments may follow it
_STL_HEADER = 80  # bytes of free text; it must not begin with "solid", by which readers know STL in text form


def write(model: Model, path: Path) -> None:
    """Write .ply or .stl, by the suffix of `path`; OSError where that fails, OutputError for a scene without faces."""
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
