"""A scene to an image of its radiance, by path tracing with Mitsuba 3.

Mitsuba wants what this file gives it: an origin near the camera (it computes in single precision), textures that are
already linear, and principal point offsets of the opposite sign of what one expects. Its version for LLVM is many times
faster than the scalar one, but aborts the process with an LLVM that is too old, so one is chosen here by its name.
"""

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np

from linecad.arrays import Float
from linecad.dataset.light import LAMP, SKY_IN_ROOMS, Light
from linecad.dataset.modelling import Material, Model
from linecad.dataset.textures import Image, sky, texture
from linecad.dataset.view import View

LLVM_VARIABLE = "DRJIT_LIBLLVM_PATH"
LLVM_PLACES = ("/usr/lib", "/usr/lib64", "/usr/local/lib")
OLDEST_LLVM = 17  # older ones cannot translate Dr.Jit's `minimum` on x86

PASS = 2 * 3840 * 2160  # samples rendered at a time, which bounds the memory
BRIGHTEST = 4.0  # radiance of one pass above which a pixel is a firefly
BOUNCES_OUTDOORS, BOUNCES_IN_ROOMS = 3, 6  # segments of a path of light
REACH = 1000.0  # m
LEVEL = 1e-3  # rad; the direction up a slope below it is not sure
FILTER = 0.45  # px, standard deviation of a pixel's footprint


def find_llvm() -> Path | None:
    """The newest LLVM library that Mitsuba can use: as the environment names it, else where systems keep it."""
    named = os.environ.get(LLVM_VARIABLE)
    if named:
        return Path(named)
    found: list[tuple[int, Path]] = []
    for place in map(Path, LLVM_PLACES):
        for pattern in ("libLLVM*", "*/libLLVM*", "llvm*/lib/libLLVM*"):
            for path in place.glob(pattern):
                version = re.fullmatch(r"libLLVM(?:-|\.so\.)(\d+).*", path.name)
                if version and int(version[1]) >= OLDEST_LLVM:
                    found.append((int(version[1]), path))
    return max(found, default=(0, None))[1]


def choose_variant() -> str:
    """Make Mitsuba ready and say what computes: "llvm_ad_rgb", or "scalar_rgb" where no LLVM is found."""
    library = find_llvm()
    if library is not None:
        os.environ[LLVM_VARIABLE] = str(library)
    variant = "scalar_rgb" if library is None else "llvm_ad_rgb"
    mi.set_variant(variant)
    return variant


def load(model: Model, view: View, light: Light, width: int, height: int) -> Any:
    """Mitsuba's form of a scene; `choose_variant` comes first."""
    scene: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": BOUNCES_IN_ROOMS if light.lamp else BOUNCES_OUTDOORS},
        "sensor": _sensor(view, width, height),
        "sky": {
            "type": "envmap",
            "bitmap": mi.Bitmap(sky(np.random.default_rng(light.sky_seed))),
            "scale": SKY_IN_ROOMS if light.lamp else 1.0,
            "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90),  # its own up is y
        },
    }
    if light.sun.any():
        irradiance = {"type": "rgb", "value": light.sun.tolist()}
        scene["sun"] = {"type": "directional", "direction": light.towards.tolist(), "irradiance": irradiance}
    if light.lamp is not None:
        scene["lamp"] = _lamp(*light.lamp, view.eye)
    corners = model.quads(view.eye)
    by_material: dict[Material, list[int]] = {}
    for index, material in enumerate(model.materials):
        by_material.setdefault(material, []).append(index)
    for number, (material, indices) in enumerate(by_material.items()):
        tile, side = texture(material)
        quads = corners[indices]
        place = _own_coordinates(quads) if model.has_frames else _texture_coordinates(quads + view.eye)
        mesh = _mesh(f"m{number}", quads, place / side, _surface(material, tile))
        scene[f"m{number}"] = mesh
    return mi.load_dict(scene)


def render(scene: Any, samples: int, seed: int, on_pass: Callable[[int], None]) -> Image:
    """Linear radiance (H, W, 3) from so many samples a pixel; `on_pass` hears how many are done.

    The bits depend on the processor and on the versions of Mitsuba and LLVM.
    """
    width, height = scene.sensors()[0].film().size()
    at_once = max(1, min(samples, PASS // (width * height)))
    total = np.zeros((height, width, 3), np.float32)
    done = 0
    while done < samples:
        count = min(at_once, samples - done)
        image = np.array(mi.render(scene, spp=count, seed=mi.UInt32(seed % 2**31 + done)))[..., :3]
        total += count * np.clip(np.nan_to_num(image), 0, BRIGHTEST)
        done += count
        on_pass(done)
    return np.asarray(total / samples, np.float32)


def _sensor(view: View, width: int, height: int) -> dict[str, Any]:
    matrix, rotation = view.matrix(width, height), view.rotation()
    to_world = np.eye(4)
    to_world[:3, :3] = np.stack([-rotation[0], -rotation[1], rotation[2]], axis=1)  # its x is left, its y up
    # Its pixels begin at their corner, ours at their centre.
    x, y = (matrix[0, 2] + 0.5) / width - 0.5, (matrix[1, 2] + 0.5) / height - 0.5
    return {
        "type": "perspective",
        "fov_axis": "x",
        "fov": float(np.degrees(2 * np.arctan(width / (2 * matrix[0, 0])))),
        "principal_point_offset_x": -float(x),
        "principal_point_offset_y": -float(y),
        "near_clip": 0.05,
        "far_clip": REACH,
        "to_world": mi.ScalarTransform4f(to_world.astype(np.float32)),
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "gaussian", "stddev": FILTER},
        },
        "sampler": {"type": "independent"},
    }


def _lamp(corner: Float, first: Float, second: Float, eye: Float) -> dict[str, Any]:
    """A rectangle that shines to the side from which its sides turn clockwise."""
    to_world = np.eye(4)
    to_world[:3, 0], to_world[:3, 1] = first / 2, -second / 2
    to_world[:3, 2] = np.cross(to_world[:3, 0], to_world[:3, 1])
    to_world[:3, 3] = corner + (first + second) / 2 - eye
    radiance = {"type": "rgb", "value": list(LAMP)}
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f(to_world.astype(np.float32)),
        "emitter": {"type": "area", "radiance": radiance},
    }


def _surface(material: Material, tile: Image) -> dict[str, Any]:
    bitmap = {"type": "bitmap", "data": mi.TensorXf(tile), "raw": True, "wrap_mode": "repeat"}
    diffuse = {"type": "diffuse", "reflectance": bitmap}
    if material.pattern not in ("glass", "paint"):
        return {"type": "twosided", "surface": diffuse}
    # A rough mirror over the colour. A smooth one would show far edges that the ground truth does not have.
    share, rough = (0.35, 0.06) if material.pattern == "glass" else (0.1, 0.15)
    gloss = {"type": "roughconductor", "material": "none", "alpha": rough}
    return {"type": "twosided", "surface": {"type": "blendbsdf", "weight": share, "a": diffuse, "b": gloss}}


def _mesh(name: str, quads: Float, coordinates: Float, surface: dict[str, Any]) -> Any:
    """A mesh of quads (N, 4, 3), two triangles each, with texture coordinates (N, 4, 2)."""
    count = len(quads)
    first = 4 * np.arange(count, dtype=np.uint32)[:, None]
    faces = np.stack([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])], axis=1)
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(surface)
    mesh = mi.Mesh(name, 4 * count, 2 * count, props=properties, has_vertex_texcoords=True)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = quads.astype(np.float32).ravel()
    parameters["vertex_texcoords"] = coordinates.astype(np.float32).ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    parameters.update()
    return mesh


def _texture_coordinates(quads: Float) -> Float:
    """(N, 4, 2) m: for each quad (N, 4, 3) the two coordinates other than the one that it faces most."""
    normal = np.abs(np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0]))
    others = np.array([[1, 2], [0, 2], [0, 1]])[normal.argmax(axis=1)]
    return np.take_along_axis(quads, np.broadcast_to(others[:, None], (len(quads), 4, 2)), axis=2)


def _own_coordinates(quads: Float) -> Float:
    """(N, 4, 2) m: for each quad (N, 4, 3) those along its level direction and up its slope; x and y where it is level.

    So courses run level at any angle, and two quads of one plane share them.
    """
    normal = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    leading = 2 - (np.abs(normal[:, ::-1]) > LEVEL).argmax(axis=1)
    normal *= np.sign(np.take_along_axis(normal, leading[:, None], axis=1))  # two sides of one plane share the courses
    level = np.stack([-normal[:, 1], normal[:, 0], np.zeros(len(normal))], axis=1)
    size = np.linalg.norm(level, axis=1, keepdims=True)
    level = np.where(size < LEVEL, (1.0, 0.0, 0.0), level / np.maximum(size, LEVEL))
    own = np.stack([level, np.cross(normal, level)], axis=2)
    coordinates: Float = quads @ own
    return coordinates
