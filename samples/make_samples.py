"""Make the sample photos: render each scene, write the photo, its camera file and its ground truth.

    python samples/make_samples.py [--output DIR] [--width PX] [SCENE ...]

The same arguments give the same files, byte for byte, on the same versions of NumPy and Pillow.
"""

import argparse
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import ExifTags, Image

import courtyard
import groundtruth
import room
import street
from lighting import Light, LightMap, indoor_light, light_maps, outdoor_light
from modelling import Face, Float, Model
from raycaster import Sun, View, see, shade

WIDTH = 1600  # px
ASPECT = 1.5
SUBSAMPLES = 3  # along each side of a pixel
DIAGONAL_35MM = 43.27  # mm
LIGHT_SPACING = 0.11  # m between the points of a light map, at full width
LEAST_LIGHT_DETAIL = 0.3  # of the full-width detail, however small the photo
SUN_RADIUS = 0.006  # rad; a little more than the real one, for shadows with soft borders
JPEG_QUALITY = 88


@dataclass(frozen=True)
class Sample:
    """One scene and the camera that looks at it."""

    build: Callable[[], Model]
    light: Callable[[float], Light]  # quality 0..1 -> soft light
    sun: tuple[float, float, float]  # towards the sun, world
    sun_light: tuple[float, float, float]  # irradiance / pi at right angles
    exposure: float
    position: tuple[float, float, float]  # of the camera, world, m
    angles: tuple[float, float, float]  # yaw to the right, pitch up, roll clockwise, rad
    equivalent: float  # 35 mm equivalent focal length, mm
    centre: tuple[float, float] = (0.0, 0.0)  # principal point off the middle, in widths
    distortion: tuple[float, ...] = ()  # k1 k2 p1 p2
    has_exif: bool = False
    seed: int = 0


def _outdoors(quality: float) -> Light:
    return outdoor_light(max(8, round(56 * quality)))


def _indoors(quality: float) -> Light:
    return indoor_light(room.LAMPS, room.AMBIENT, max(4, round(40 * quality)), max(6, round(40 * quality)))


SAMPLES = {
    "street": Sample(
        build=street.build,
        light=_outdoors,
        sun=(-0.62, -0.42, 0.78),
        sun_light=(1.55, 1.42, 1.2),
        exposure=0.95,
        position=(0.5, 0.0, 1.6),
        angles=(0.33, 0.10, -0.015),
        equivalent=24.4,
        centre=(0.004, -0.003),
        seed=1,
    ),
    "courtyard": Sample(
        build=courtyard.build,
        light=_outdoors,
        sun=(0.5, -0.42, 0.72),
        sun_light=(1.55, 1.42, 1.2),
        exposure=0.95,
        position=(0.4, 0.0, 1.6),
        angles=(-0.36, 0.08, 0.014),
        equivalent=23.6,
        centre=(-0.003, 0.002),
        distortion=(-0.055, 0.012, 0.0004, -0.0003),
        seed=2,
    ),
    "room": Sample(
        build=room.build,
        light=_indoors,
        sun=(-0.80, 0.22, 0.62),
        sun_light=(3.6, 3.2, 2.6),
        exposure=0.95,
        position=(0.45, -0.7, 1.5),
        angles=(-0.37, -0.09, 0.012),
        equivalent=24.0,
        has_exif=True,
        seed=3,
    ),
}


def view_of(sample: Sample, width: int) -> View:
    """The camera of a sample at a width in px."""
    height = round(width / ASPECT)
    focal = sample.equivalent / DIAGONAL_35MM * np.hypot(width, height)
    x, y = (width - 1) / 2 + sample.centre[0] * width, (height - 1) / 2 + sample.centre[1] * width
    yaw, pitch, roll = sample.angles
    forward = np.array([np.sin(yaw) * np.cos(pitch), np.cos(yaw) * np.cos(pitch), np.sin(pitch)])
    right = np.array([np.cos(yaw), -np.sin(yaw), 0.0])
    down = np.cross(forward, right)
    rotation = np.stack(
        [np.cos(roll) * right + np.sin(roll) * down, np.cos(roll) * down - np.sin(roll) * right, forward]
    )
    matrix = np.array([[focal, 0, x], [0, focal, y], [0, 0, 1]])
    return View(width, height, matrix.round(6), rotation, np.array(sample.position), sample.distortion)


def render(sample: Sample, faces: list[Face], view: View) -> Float:
    """Radiance (H, W, 3) of the photo, the mean of several rays through each pixel."""
    quality = min(1.0, view.width / WIDTH)
    light, sun_light = sample.light(quality), np.array(sample.sun_light)
    grid = np.stack(np.meshgrid(np.arange(view.width), np.arange(view.height)), axis=-1).astype(float)
    sun = np.array(sample.sun) / np.linalg.norm(sample.sun)
    across = np.linalg.qr(np.column_stack([sun, np.eye(3)[:, :2]]))[0][:, 1:]
    maps: dict[int, LightMap] = {}
    total = np.zeros((view.height, view.width, 3))
    for number, (y, x) in enumerate(np.ndindex(SUBSAMPLES, SUBSAMPLES)):
        # Each ray through a pixel sees another point of the sun, which softens the borders of shadows.
        radius, turn = SUN_RADIUS * np.sqrt((number + 0.5) / SUBSAMPLES**2), 2.4 * number
        direction = sun + across @ (radius * np.array([np.cos(turn), np.sin(turn)]))
        rays, depth, index = see(faces, view, grid + (np.array([x, y]) + 0.5) / SUBSAMPLES - 0.5)
        new = np.setdiff1d(index[index >= 0], list(maps))
        maps |= light_maps(faces, new, light, LIGHT_SPACING / max(quality, LEAST_LIGHT_DETAIL))
        radiance = shade(
            faces, view, rays.reshape(-1, 3), depth.ravel(), index.ravel(), maps, Sun(faces, direction, sun_light)
        )
        total += radiance.reshape(total.shape)
    return total / SUBSAMPLES**2


def develop(radiance: Float, exposure: float, seed: int) -> NDArray[np.uint8]:
    """What a camera makes of the radiance: vignetting, slight blur, film curve, sensor noise, 8-bit sRGB."""
    height, width = radiance.shape[:2]
    y, x = np.mgrid[0:height, 0:width]
    off = ((x - width / 2) ** 2 + (y - height / 2) ** 2) / (width**2 + height**2) * 4
    light = radiance * exposure * (1 - 0.16 * off[..., None])
    for axis in (0, 1):
        size = light.shape[axis]
        before, after = (np.clip(np.arange(size) + step, 0, size - 1) for step in (-1, 1))
        light = 0.72 * light + 0.14 * (light.take(before, axis) + light.take(after, axis))
    rng = np.random.default_rng(seed)
    light = light + rng.standard_normal(light.shape) * np.sqrt(np.maximum(light, 0) * 6e-5 + 4e-6)
    curve = np.clip(light, 0, None)
    curve = curve * (1 + curve / 2.6) / (1 + curve)  # Reinhard's curve with white at 2.6
    curve = np.clip(curve * 1.25, 0, 1)
    encoded = np.where(curve <= 0.0031308, 12.92 * curve, 1.055 * curve ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(255 * encoded), np.uint8)


def make(name: str, width: int, folder: Path) -> None:
    """Render one sample and write its three files."""
    sample = SAMPLES[name]
    view = view_of(sample, width)
    faces = sample.build().faces
    pixels = develop(render(sample, faces, view), sample.exposure, sample.seed)
    exif = Image.Exif()
    if sample.has_exif:
        tags = exif.get_ifd(ExifTags.IFD.Exif)
        tags[ExifTags.Base.FocalLengthIn35mmFilm] = round(sample.equivalent)
        tags[ExifTags.Base.ExifImageWidth], tags[ExifTags.Base.ExifImageHeight] = view.width, view.height
    Image.fromarray(pixels).save(folder / f"{name}.jpg", quality=JPEG_QUALITY, optimize=True, exif=exif)
    camera = {
        "width": view.width,
        "height": view.height,
        "K": view.matrix.tolist(),
        "distortion": list(view.distortion),
    }
    (folder / f"{name}.json").write_text(json.dumps(camera) + "\n", encoding="utf-8")
    truth = {"image": f"{name}.jpg"} | groundtruth.ground_truth(sample.build(), view, sample.seed)
    (folder / f"{name}.truth.json").write_text(json.dumps(truth, separators=(",", ":")) + "\n", encoding="utf-8")


def main() -> None:
    """Parse the command line and make the samples."""
    parser = argparse.ArgumentParser(description="Make the sample photos with their cameras and ground truth.")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"one or more of {', '.join(SAMPLES)}; default: all")
    parser.add_argument("--output", type=Path, default=Path(__file__).parent, help="folder (default: this one)")
    parser.add_argument("--width", type=int, default=WIDTH, help="px (default: %(default)s)")
    arguments = parser.parse_args()
    unknown = set(arguments.scenes) - set(SAMPLES)
    if unknown:
        parser.error(f"no scene is called {', '.join(sorted(unknown))}")
    for name in arguments.scenes or SAMPLES:
        make(name, arguments.width, arguments.output)
        print(f"{name}: {arguments.width} px wide, in {arguments.output}")


if __name__ == "__main__":
    main()
