"""Made photos with a known camera that are cheap to make, and what can be done to them: bent, cut, turned.

The scenes are those of `linecad dataset` (streets, courtyards, rooms), the cameras random. They are drawn without
shadows and reflections, at twice the size and reduced, then blurred, made noisy and stored as JPEG, so that the real
detector finds what it finds. A *canvas* is such a picture before it is reduced; its camera is exact.
"""

from dataclasses import dataclass, replace
from functools import cache

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from linecad.arrays import Float, Int
from linecad.dataset.modelling import Model
from linecad.dataset.rasteriser import rasterise
from linecad.dataset.scenes import SceneKind, draw_scene
from linecad.dataset.textures import clouds, texture
from linecad.dataset.truth import NOTHING
from linecad.dataset.view import View
from linecad.geometry import rotation_about

OF_TEN: tuple[SceneKind, ...] = (*("street",) * 4, *("courtyard",) * 3, *("room",) * 3)
LONG_SIDE = (640.0, 1600.0)  # px
ASPECTS = (4 / 3, 3 / 2, 16 / 9)
PORTRAIT = 0.25  # share of the photos that stand upright
FOCAL = (0.6, 2.0)  # of the larger side
PITCH, YAW, ROLL = np.radians(25.0), np.radians(60.0), np.radians(5.0)  # largest
OFF_CENTRE = 0.006  # of the larger side, one standard deviation of the principal point
FROM_ABOVE = np.radians(-8.0)  # a camera that looks down further stands above the street
HIGH = (5.0, 16.0)  # m, where it stands then
SECOND_FRAME = np.radians((15.0, 75.0))  # by which a house is turned against the others
CAMERA_TRIES = 40
LEAST_LENGTH = 0.03  # of the larger side; shorter edges do not count in the next two numbers
LEAST_EDGES, LEAST_OF_SECOND = 40, 12  # edges before the camera, in all and along the second most common axis

SUPER = 2  # canvas pixels along a pixel of the photo
TALLEST_SHARE = 0.25  # px of a canvas; quads that are smaller both ways are not drawn
LEVELS = 8  # of a texture, each of half the size of the one before
AMBIENT = (0.35, 0.75)  # share of the light that comes from everywhere
CONTRAST = (0.45, 1.0)
CABLES = 5  # most lines of no direction that hang in a picture
BLUR = (0.25, 0.8)  # px
NOISE = (0.5, 5.0)  # of 255
QUALITY = (72, 97)  # of the JPEG file


@dataclass(frozen=True, eq=False)
class Canvas:
    """A picture with its exact camera: `pixel ~ matrix @ bend(rotation @ point)`, bend being OpenCV's k1."""

    pixels: NDArray[np.uint8]  # (H, W, 3) RGB
    matrix: Float  # (3, 3) K, px of the canvas
    rotation: Float  # (3, 3) world to camera
    radial: float = 0.0  # k1
    second: Float | None = None  # (3, 3) a second Manhattan frame in the scene to camera

    def project(self, points: Float) -> Float:
        """Pixels (N, 2) of world points (N, 3) before the camera."""
        camera = points @ self.rotation.T
        flat = camera[:, :2] / camera[:, 2:]
        flat = flat * (1 + self.radial * (flat**2).sum(axis=1, keepdims=True))
        pixels: Float = flat @ self.matrix[:2, :2].T + self.matrix[:2, 2]
        return pixels


@dataclass(frozen=True, eq=False)
class Shot:
    """A scene and the camera before it."""

    model: Model
    view: View
    width: int  # px of the photo
    height: int


def draw_shot(seed: int, index: int) -> Shot:
    """Scene and camera number `index` of a seed."""
    rng = np.random.default_rng([seed, index])
    kind = OF_TEN[index % len(OF_TEN)]
    model, view = draw_scene(kind, rng)
    longer = float(np.exp(rng.uniform(*np.log(LONG_SIDE))))
    width, height = round(longer), round(longer / float(rng.choice(ASPECTS)))
    if rng.random() < PORTRAIT:
        width, height = height, width
    edges = model.edges()[0]
    for _ in range(CAMERA_TRIES):
        shot = Shot(model, _draw_view(view, kind, width, rng, longer), width, height)
        if _shows_enough(edges, shot):
            break
    return shot


def _draw_view(view: View, kind: SceneKind, width: int, rng: Generator, longer: float) -> View:
    pitch = float(rng.uniform(-PITCH, PITCH))
    eye = view.eye.copy()
    if kind != "room" and pitch < FROM_ABOVE:
        eye[2] = rng.uniform(*HIGH)
    off = rng.normal(0, OFF_CENTRE, 2) * longer / width
    return View(
        eye=eye,
        yaw=float(rng.uniform(-YAW, YAW)),
        pitch=pitch,
        roll=float(rng.uniform(-ROLL, ROLL)),
        focal=float(np.exp(rng.uniform(*np.log(FOCAL)))) * longer / width,
        off_centre=(float(off[0]), float(off[1])),
    )


def with_turned_house(shot: Shot, rng: Generator) -> tuple[Shot, Float]:
    """The same scene with the house that shows the most turned about its middle, and the turn (3, 3).

    In a room, the piece of furniture with the most edges is turned.
    """
    model, (ends, body) = shot.model, shot.model.edges()
    camera = (ends.mean(axis=1) - shot.view.eye) @ shot.view.rotation().T
    image = camera @ shot.view.matrix(shot.width, shot.height).T
    inside = (image[:, :2] >= 0).all(axis=1) & (image[:, :2] < image[:, 2:] * (shot.width, shot.height)).all(axis=1)
    can_turn = np.isin([model.kinds[number] for number in body], ["building", "furniture"]) & inside
    # Of a room the walls are a building too, and they are what the frame is.
    if "furniture" in model.kinds:
        can_turn &= np.array([model.kinds[number] for number in body]) == "furniture"
    if not can_turn.any():
        return shot, np.eye(3)
    chosen = int(np.bincount(body[can_turn]).argmax())
    middle = ends[body == chosen].reshape(-1, 3).mean(axis=0)
    turn = rotation_about(np.array([0.0, 0.0, rng.uniform(*SECOND_FRAME)]))

    def moved(points: list[Float], owners: list[int]) -> list[Float]:
        return [
            (point - middle) @ turn.T + middle if owner == chosen else point
            for point, owner in zip(points, owners, strict=True)
        ]

    corners, own_ends = moved(model.corners, model.body), moved(model.ends, model.edge_body)
    return replace(shot, model=replace(model, corners=corners, ends=own_ends)), turn


def _shows_enough(edges: Float, shot: Shot) -> bool:
    """Whether two directions have edges before the camera; things that hide others are not asked."""
    camera = (edges - shot.view.eye) @ shot.view.rotation().T
    before = (camera[..., 2] > 0.1).all(axis=1)
    image = camera[before] @ shot.view.matrix(shot.width, shot.height).T
    image = image[..., :2] / image[..., 2:]
    middle, length = image.mean(axis=1), np.linalg.norm(image[:, 1] - image[:, 0], axis=1)
    shown = ((middle >= 0) & (middle < (shot.width, shot.height))).all(axis=1)
    shown &= length > LEAST_LENGTH * max(shot.width, shot.height)
    axis = np.abs(edges[before][shown, 1] - edges[before][shown, 0]).argmax(axis=1)
    return len(axis) >= LEAST_EDGES and np.sort(np.bincount(axis, minlength=3))[1] >= LEAST_OF_SECOND


def draw_canvas(shot: Shot, rng: Generator) -> Canvas:
    """The picture of a shot at SUPER times its size."""
    width, height = SUPER * shot.width, SUPER * shot.height
    matrix, rotation = enlarged(shot.view.matrix(shot.width, shot.height), SUPER), shot.view.rotation()
    quads = shot.model.quads(shot.view.eye)
    large = _large_enough(quads, matrix, rotation)
    ids, inverse_depth = rasterise(quads[large], matrix, rotation, width, height)
    kept = [shot.model.materials[index] for index in np.flatnonzero(large)]
    tones = _tones([material.pattern for material in kept], quads[large], ids, inverse_depth, matrix, rotation, shot)
    light = _light(quads[large], rng)
    colour = np.array([material.colour for material in kept]) * light[:, None]
    sky = np.array(rng.uniform((0.55, 0.65, 0.7), (0.85, 0.9, 1.0)))
    value = np.vstack([colour, sky[None]]).astype(np.float32)[ids] * tones[..., None]
    contrast, level = rng.uniform(*CONTRAST), rng.uniform(0.35, 0.65)
    value = level + contrast * (value - float(value.mean()))
    pixels = np.clip(255 * value + 0.5, 0, 255).astype(np.uint8)
    _hang_cables(pixels, rng)
    return Canvas(pixels, matrix, rotation)


def _large_enough(quads: Float, matrix: Float, rotation: Float) -> NDArray[np.bool_]:
    """Quads (Q,) that are not all before the camera, or whose image is not tiny."""
    image = quads @ (matrix @ rotation).T
    depth = image[..., 2]
    behind = (depth < 0.05).any(axis=1)
    flat = image[..., :2] / np.where(depth > 0.05, depth, 1.0)[..., None]
    size = np.ptp(flat, axis=1)
    large: NDArray[np.bool_] = behind | (size.max(axis=1) > TALLEST_SHARE)
    return large


def _light(quads: Float, rng: Generator) -> Float:
    """How brightly each quad (Q,) is lit, from 0 to 1, by a sun somewhere and by the sky."""
    normal = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    normal *= np.where((normal * quads[:, 0]).sum(axis=1) > 0, -1, 1)[:, None]  # towards the camera
    azimuth, elevation = rng.uniform(-np.pi, np.pi), rng.uniform(0.3, 1.2)
    sun = np.array([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)])
    ambient = rng.uniform(*AMBIENT)
    light: Float = ambient * (0.85 + 0.15 * normal[:, 2]) + (1 - ambient) * np.clip(normal @ sun, 0, None)
    return light


@cache
def _pyramid() -> tuple[NDArray[np.float32], dict[str, Int], dict[str, tuple[float, int]]]:
    """All textures at all levels in one row; where each level begins, and the side, m, and texels of level 0."""
    from linecad.dataset.modelling import Material

    pieces: list[NDArray[np.float32]] = []
    begins: dict[str, Int] = {}
    sizes: dict[str, tuple[float, int]] = {}
    total = 0
    for pattern in ("plain", "brick", "panel", "ashlar", "slabs", "asphalt", "glass", "paint", "leaves"):
        tile, side = texture(Material(pattern, (0.5, 0.5, 0.5)))
        level = np.ascontiguousarray(tile[..., 0] / tile[..., 0].mean())
        sizes[pattern] = (side, len(level))
        starts = []
        for _ in range(LEVELS):
            starts.append(total)
            pieces.append(level.ravel())
            total += level.size
            level = level.reshape(len(level) // 2, 2, -1, 2).mean(axis=(1, 3))
        begins[pattern] = np.array(starts)
    return np.concatenate(pieces), begins, sizes


def _tones(
    patterns: list[str], quads: Float, ids: Int, inverse_depth: Float, matrix: Float, rotation: Float, shot: Shot
) -> NDArray[np.float32]:
    """(H, W) brightness of the texture at each pixel relative to its surface; 1 in the sky."""
    row, begins, sizes = _pyramid()
    texels = np.array([sizes[pattern][1] for pattern in patterns] + [1 << (LEVELS - 1)], np.int32)
    density = texels / np.array([sizes[pattern][0] for pattern in patterns] + [1.0], np.float32)  # texels a metre
    start = np.array([begins[pattern] for pattern in patterns] + [begins["plain"]], np.int32)
    normal = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    facing = np.append(np.abs(normal).argmax(axis=1), 0).astype(np.int8)
    height, width = ids.shape
    x, y = np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)[:, None]
    depth = 1 / np.maximum(inverse_depth, 1e-4).astype(np.float32)
    way = np.linalg.inv(matrix @ rotation).astype(np.float32)
    eye = shot.view.eye.astype(np.float32)
    world = [(way[k, 0] * x + (way[k, 1] * y + way[k, 2])) * depth + eye[k] for k in range(3)]
    face, dense = facing[ids], density[ids].astype(np.float32)
    first, second = np.where(face == 0, world[1], world[0]), np.where(face == 2, world[1], world[2])
    footprint = depth * dense / np.float32(matrix[0, 0])  # texels along a pixel
    level = np.clip(np.log2(np.maximum(footprint, 1)) + np.float32(0.5), 0, LEVELS - 1).astype(np.int8)
    count = texels[ids] >> level
    scale = np.ldexp(dense, -level)
    column = np.floor(first * scale).astype(np.int32) & (count - 1)
    line = np.floor(second * scale).astype(np.int32) & (count - 1)
    tone: NDArray[np.float32] = row[start[ids, level] + line * count + column]
    tone[ids == NOTHING] = 1
    return tone


def _hang_cables(pixels: NDArray[np.uint8], rng: Generator) -> None:
    """Draw straight dark lines of random directions across the picture: clutter that no axis explains."""
    height, width = pixels.shape[:2]
    for _ in range(int(rng.integers(0, CABLES + 1))):
        middle, angle = rng.uniform((0, 0), (width, height)), rng.uniform(0, np.pi)
        reach = rng.uniform(0.05, 0.3) * max(width, height) * np.array([np.cos(angle), np.sin(angle)])
        ends = np.rint(16 * np.array([middle - reach, middle + reach])).astype(int)
        tone = int(rng.integers(10, 200))
        cv2.line(pixels, ends[0].tolist(), ends[1].tolist(), (tone,) * 3, int(rng.integers(1, 5)), cv2.LINE_AA, 4)


def enlarged(matrix: Float, factor: float) -> Float:
    """The camera of a picture `factor` times as large; the centre of the first pixel stays at (0, 0)."""
    middle = (factor - 1) / 2
    larger: Float = np.array([[factor, 0.0, middle], [0.0, factor, middle], [0.0, 0.0, 1.0]]) @ matrix
    return larger


def bent(canvas: Canvas, radial: float) -> Canvas:
    """The same as a lens with k1 = `radial` shows it, as large, with nothing missing at the border.

    A barrel is enlarged until its corners are those of the straight picture.
    """
    height, width = canvas.pixels.shape[:2]
    focal, centre = canvas.matrix[0, 0], canvas.matrix[:2, 2]
    corners = np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]]) - centre
    furthest = float(np.linalg.norm(corners, axis=1).max()) / focal
    if 1 + 3 * radial * furthest**2 <= 0:
        raise ValueError(f"k1 = {radial} folds a picture that reaches {furthest:.2f} focal lengths from its middle")
    larger = 1 / (1 + radial * furthest**2) if radial < 0 else 1.0
    straight = np.linspace(0, 1.01 * furthest, 20_000)
    y, x = np.mgrid[:height, :width].astype(np.float64)
    across, down = x - centre[0], y - centre[1]
    seen = np.hypot(across, down) / (focal * larger)
    factor = np.interp(seen, straight * (1 + radial * straight**2), straight) / np.maximum(seen, 1e-12) / larger
    source_x, source_y = (centre[0] + across * factor), (centre[1] + down * factor)
    pixels = cv2.remap(
        canvas.pixels, source_x.astype(np.float32), source_y.astype(np.float32), cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_REPLICATE,
    )  # fmt: skip
    matrix = canvas.matrix.copy()
    matrix[0, 0] *= larger
    matrix[1, 1] *= larger
    return replace(canvas, pixels=np.asarray(pixels, np.uint8), matrix=matrix, radial=radial)


def cropped(canvas: Canvas, left: int, top: int, width: int, height: int) -> Canvas:
    """A part of the picture, px of the canvas."""
    matrix = canvas.matrix.copy()
    matrix[:2, 2] -= (left, top)
    return replace(canvas, pixels=canvas.pixels[top : top + height, left : left + width], matrix=matrix)


def turned(canvas: Canvas, quarters: int) -> Canvas:
    """The picture turned clockwise by quarters of a full turn."""
    for _ in range(quarters % 4):
        height = canvas.pixels.shape[0]
        turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
        x, y = canvas.matrix[:2, 2]
        matrix = canvas.matrix.copy()
        matrix[:2, 2] = (height - 1 - y, x)
        canvas = replace(canvas, pixels=np.rot90(canvas.pixels, -1), matrix=matrix, rotation=turn @ canvas.rotation)
    return canvas


def finished(canvas: Canvas, rng: Generator) -> tuple[bytes, Float]:
    """The photo as a JPEG file, and its camera matrix (3, 3), px."""
    height, width = canvas.pixels.shape[0] // SUPER, canvas.pixels.shape[1] // SUPER
    even = np.ascontiguousarray(canvas.pixels[: SUPER * height, : SUPER * width])
    small = cv2.resize(even, (width, height), interpolation=cv2.INTER_AREA).astype(np.float32)
    small = np.asarray(cv2.GaussianBlur(small, (0, 0), rng.uniform(*BLUR)), np.float32)
    deviation = rng.uniform(*NOISE)
    stained = small + 2.0 * cv2.resize(clouds(rng, 256, 1.0).astype(np.float32), (width, height))[..., None]
    noisy = stained + deviation * rng.standard_normal(small.shape, np.float32)
    pixels = np.clip(noisy + 0.5, 0, 255).astype(np.uint8)
    quality = int(rng.integers(*QUALITY))
    done, data = cv2.imencode(".jpg", np.ascontiguousarray(pixels[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert done
    return data.tobytes(), enlarged(canvas.matrix, 1 / SUPER)
