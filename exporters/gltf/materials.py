"""The materials of a GLB, and the pictures in it.

Lines are unlit, because a line has no normal for light to fall on; so are faces with the photo on them, because the
light of the day is in it already. Faces without it are lit.
"""

from typing import Any

from exporters.colours import RGB, face_colour, face_colour_name, line_colour, linear
from exporters.gltf.faces import FaceMesh
from exporters.model import Model
from exporters.textures.pages import MEDIA_TYPE, Textures
from linecad.scene import FaceKind

_UNLIT = "KHR_materials_unlit"
_LINEAR, _LINEAR_MIPMAP_LINEAR, _CLAMP_TO_EDGE = 9729, 9987, 33071  # as OpenGL numbers them
_ALIGNMENT = 4  # bytes; every view of the buffer starts at a multiple of it

_Tree = dict[str, Any]  # the JSON document of a glTF file


def add_pictures(buffer: Any, textures: Textures) -> None:
    """Append the pages to the buffer that trimesh makes, a dictionary of padded views."""
    for page in textures.pages:
        buffer[page.name] = page.data + bytes(-len(page.data) % _ALIGNMENT)


def set_materials(tree: _Tree, model: Model, meshes: dict[str, FaceMesh], textures: Textures | None) -> None:
    """Give every mesh its material, and the document its pictures, which are the last views of the buffer.

    `meshes` are those of the faces, by any name.
    """
    materials = {group.name: _unlit(group.name, line_colour(group.axis, group.is_boundary)) for group in model.groups}
    if textures is None:
        materials |= {mesh.name: _face_material(mesh.face.kind) for mesh in meshes.values()}
    else:
        pages = [_photo_material(number) for number in range(len(textures.pages))]
        materials |= {mesh.name: pages[textures.page(mesh.shown)] for mesh in meshes.values()}
        _set_pictures(tree, textures)
    tree["materials"] = []
    for mesh in tree["meshes"]:
        material = materials[mesh["name"]]
        if material not in tree["materials"]:
            tree["materials"].append(material)
        for primitive in mesh["primitives"]:
            primitive["material"] = tree["materials"].index(material)
    if any("extensions" in material for material in tree["materials"]):
        tree["extensionsUsed"] = [_UNLIT]


def _set_pictures(tree: _Tree, textures: Textures) -> None:
    first = len(tree["bufferViews"]) - len(textures.pages)
    images = []
    for number, page in enumerate(textures.pages):
        tree["bufferViews"][first + number]["byteLength"] = len(page.data)  # without what pads it
        images.append({"name": _page_name(number), "mimeType": MEDIA_TYPE, "bufferView": first + number})
    sampler = {
        "magFilter": _LINEAR,
        "minFilter": _LINEAR_MIPMAP_LINEAR,
        "wrapS": _CLAMP_TO_EDGE,
        "wrapT": _CLAMP_TO_EDGE,
    }
    if images:
        tree["images"], tree["samplers"] = images, [sampler]
        tree["textures"] = [{"sampler": 0, "source": number} for number in range(len(images))]


def _page_name(number: int) -> str:
    return f"photo_{number}"


def _photo_material(page: int) -> _Tree:
    return {
        "name": _page_name(page),
        "doubleSided": True,
        "extensions": {_UNLIT: {}},
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": page},
            "metallicFactor": 0.0,
            "roughnessFactor": 1.0,
        },
    }


def _face_material(kind: FaceKind) -> _Tree:
    return {
        "name": face_colour_name(kind),
        "doubleSided": True,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear(face_colour(kind)), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 1.0,
        },
    }


def _unlit(name: str, colour: RGB) -> _Tree:
    return {
        "name": name,
        "extensions": {_UNLIT: {}},
        "pbrMetallicRoughness": {
            "baseColorFactor": [*linear(colour), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 1.0,
        },
    }
