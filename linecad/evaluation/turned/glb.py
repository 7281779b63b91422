"""Everything that a GLB file shows, as plain arrays, read from its bytes: the specification of glTF 2.0 and no library.

What a picture could leave out unseen is refused instead: primitives that are neither triangles nor lines, transparent
materials, sparse or packed numbers, extensions that the file requires.
"""

import json
import struct
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Bool, Float, Int
from linecad.errors import LinecadError

MAGIC, JSON_CHUNK = 0x46546C67, 0x4E4F534A
LINES, TRIANGLES = 1, 4  # modes of a primitive
NUMBERS: dict[int, Any] = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}  # componentType
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
UNLIT = "KHR_materials_unlit"

_Tree = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Material:
    """How a surface looks."""

    colour: Float  # (3,) 0 to 1, linear light; the picture is multiplied by it
    picture: NDArray[np.uint8] | None  # (H, W, 3) RGB
    is_lit: bool
    is_double_sided: bool

    @cached_property
    def halvings(self) -> list[NDArray[np.uint8]]:
        """The picture, and each time half as large, down to one texel across; nothing without a picture."""
        pictures = [] if self.picture is None else [self.picture]
        while pictures and min(pictures[-1].shape[:2]) > 1:
            height, width = pictures[-1].shape[:2]
            smaller = cv2.resize(pictures[-1], (width // 2, height // 2), interpolation=cv2.INTER_AREA)
            pictures.append(np.asarray(smaller, np.uint8))
        return pictures


@dataclass(frozen=True, eq=False)
class PhotoCamera:
    """The camera of the photo as the file tells it."""

    matrix: Float  # (3, 3) px, pixels counted from the centre of the first
    width: int  # px
    height: int
    rotation: Float  # (3, 3) world to camera: x right, y down, z forward
    position: Float  # (3,)


@dataclass(frozen=True, eq=False)
class GlbModel:
    """All triangles and lines of a file in the frame of its world, y up."""

    triangles: Float  # (T, 3, 3) corners, counter-clockwise from the front
    texels: Float  # (T, 3, 2) places on the picture, from its upper left corner, its sides being 1; 0 without one
    material: Int  # (T,)
    lines: Float  # (L, 2, 3)
    line_material: Int  # (L,)
    materials: tuple[Material, ...]
    camera: PhotoCamera


def read_glb(path: Path) -> GlbModel:
    """The model in a GLB that linecad wrote. Raises LinecadError for what could not be drawn as it is."""
    tree, buffer = _chunks(path.read_bytes())
    if required := tree.get("extensionsRequired"):
        raise LinecadError(f"{path} requires the extensions {', '.join(required)}, which are not drawn")
    materials = tuple(_material(each, tree, buffer) for each in tree.get("materials", []))
    triangles, texels, material = [np.zeros((0, 3, 3))], [np.zeros((0, 3, 2))], [np.zeros(0, np.int64)]
    lines, line_material = [np.zeros((0, 2, 3))], [np.zeros(0, np.int64)]
    camera = None
    for node, pose in _nodes(tree):
        if "camera" in node:
            camera = _camera(tree["cameras"][node["camera"]], pose)
        for primitive in tree["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            points = _numbers(tree, buffer, primitive["attributes"]["POSITION"]) @ pose[:3, :3].T + pose[:3, 3]
            order = np.arange(len(points))
            if "indices" in primitive:
                order = _numbers(tree, buffer, primitive["indices"]).astype(np.int64).ravel()
            if primitive.get("mode", TRIANGLES) == LINES:
                lines.append(points[order].reshape(-1, 2, 3))
                line_material.append(np.full(len(lines[-1]), primitive["material"]))
            elif primitive.get("mode", TRIANGLES) == TRIANGLES:
                at = primitive["attributes"].get("TEXCOORD_0")
                places = np.zeros((len(points), 2)) if at is None else _numbers(tree, buffer, at)
                triangles.append(points[order].reshape(-1, 3, 3))
                texels.append(places[order].reshape(-1, 3, 2))
                material.append(np.full(len(triangles[-1]), primitive["material"]))
            else:
                raise LinecadError(f"{path} has a primitive of mode {primitive['mode']}, which is not drawn")
    if camera is None:
        raise LinecadError(f"{path} has no camera of the photo; write it with linecad")
    return GlbModel(
        triangles=np.concatenate(triangles),
        texels=np.concatenate(texels),
        material=np.concatenate(material),
        lines=np.concatenate(lines),
        line_material=np.concatenate(line_material),
        materials=materials,
        camera=camera,
    )


def _chunks(data: bytes) -> tuple[_Tree, bytes]:
    """The document and the buffer of a file."""
    magic, version, _ = struct.unpack_from("<III", data)
    length, kind = struct.unpack_from("<II", data, 12)
    if (magic, version, kind) != (MAGIC, 2, JSON_CHUNK):
        raise LinecadError("the file is no GLB of version 2")
    tree: _Tree = json.loads(data[20 : 20 + length])
    return tree, data[28 + length :]


def _nodes(tree: _Tree) -> list[tuple[_Tree, Float]]:
    """Every node of the scene with its pose (4, 4) in the world; a mesh that many nodes name comes many times."""
    found = []
    waiting = [(number, np.eye(4)) for number in tree["scenes"][tree.get("scene", 0)]["nodes"]]
    while waiting:
        number, above = waiting.pop()
        node = tree["nodes"][number]
        pose = above @ _pose(node)
        found.append((node, pose))
        waiting += [(child, pose) for child in node.get("children", [])]
    return found


def _pose(node: _Tree) -> Float:
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T  # stored by columns
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    pose[:3, :3] *= node.get("scale", (1.0, 1.0, 1.0))
    pose[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return pose


def _numbers(tree: _Tree, buffer: bytes, number: int) -> Float:
    """The values (N, width) of an accessor."""
    accessor = tree["accessors"][number]
    view = tree["bufferViews"][accessor["bufferView"]]
    if "byteStride" in view or "sparse" in accessor:
        raise LinecadError("the file has numbers that are interleaved or sparse, which are not read")
    width, kind = WIDTHS[accessor["type"]], NUMBERS[accessor["componentType"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    values = np.frombuffer(buffer, kind, accessor["count"] * width, start)
    return values.reshape(-1, width).astype(np.float64)


def _material(material: _Tree, tree: _Tree, buffer: bytes) -> Material:
    surface = material.get("pbrMetallicRoughness", {})
    if material.get("alphaMode", "OPAQUE") != "OPAQUE":
        raise LinecadError(f"the material {material.get('name')} is transparent, which is not drawn")
    picture = None
    if "baseColorTexture" in surface:
        image = tree["images"][tree["textures"][surface["baseColorTexture"]["index"]]["source"]]
        view = tree["bufferViews"][image["bufferView"]]
        start = view.get("byteOffset", 0)
        data = np.frombuffer(buffer, np.uint8, view["byteLength"], start)
        picture = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR_RGB), np.uint8)
    return Material(
        colour=np.array(surface.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0))[:3]),
        picture=picture,
        is_lit=UNLIT not in material.get("extensions", {}),
        is_double_sided=bool(material.get("doubleSided", False)),
    )


def _camera(camera: _Tree, pose: Float) -> PhotoCamera:
    told = camera["extras"]
    matrix = np.array(
        [
            [told["linecad_fx"], 0.0, told["linecad_cx"] - 0.5],  # the file counts from the corner of the photo
            [0.0, told["linecad_fy"], told["linecad_cy"] - 0.5],
            [0.0, 0.0, 1.0],
        ]
    )
    rotation = np.diag([1.0, -1.0, -1.0]) @ pose[:3, :3].T  # glTF's cameras look along -z with y up
    return PhotoCamera(matrix, told["linecad_width"], told["linecad_height"], rotation, pose[:3, 3])


def is_front(triangles: Float, position: Float) -> Bool:
    """Which triangles (T, 3, 3) turn their front to a point (3,)."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    seen: Bool = (normal * (position - triangles[:, 0])).sum(axis=1) > 0
    return seen
