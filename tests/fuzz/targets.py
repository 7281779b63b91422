"""What the fuzzer calls: every reader of files from outside, each refusing bad bytes only by an error of linecad's.

Also the first files that it starts from. `tests/benchmarks/fuzz.py` runs the targets; `test_corpus.py` runs them over
the small corpus that is kept.
"""

import io
import json
import struct
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from depth_files import depth_seeds
from PIL import Image

from linecad.batch.job import Figures, Outcome
from linecad.batch.record import Row, parse_row, row_line
from linecad.camera.intrinsics import read_calibration
from linecad.camera.photo import Photo, read_photo
from linecad.corrections.file import corrections_from_json, corrections_to_json
from linecad.depth.read import read_depth_map
from linecad.depth.to_photo import map_to_photo
from linecad.errors import InputError
from linecad.io.scene_file import scene_from_json, scene_to_json

CORPUS = Path(__file__).parent / "corpus"
SIDE = 64  # px, the smallest photo that is read


class Target(NamedTuple):
    """One reader under test."""

    read: Callable[[bytes, Path], None]  # the bytes, and a folder in memory for those that want a file
    is_json: bool
    seeds: Callable[[], Iterator[bytes]]
    largest: int  # bytes of one input


def read_scene_bytes(data: bytes, _folder: Path) -> None:
    """A scene file; whatever is accepted can be written, and reads back as the same text."""
    try:
        scene = scene_from_json(data.decode("utf-8-sig", "surrogatepass"))
    except (InputError, UnicodeDecodeError):  # read_scene reports text that is not UTF-8
        return
    text = scene_to_json(scene)
    assert scene_to_json(scene_from_json(text)) == text


def read_camera_bytes(data: bytes, folder: Path) -> None:
    """A camera file, whose distortion is then applied to a photo when it is for a small one."""
    path = folder / "camera.json"
    path.write_bytes(data)
    try:
        calibration = read_calibration(path)
    except InputError:
        return
    assert np.isfinite(calibration.square_matrix).all()
    if (calibration.width, calibration.height) == (SIDE, SIDE):
        photo = folder / "photo.png"
        if not photo.exists():
            photo.write_bytes(image_bytes("PNG"))
        try:
            assert read_photo(photo, path).camera is not None
        except InputError:
            return


def read_image_bytes(data: bytes, folder: Path) -> None:
    """A photo of any kind, with its EXIF data."""
    path = folder / "photo"
    path.write_bytes(data)
    try:
        photo = read_photo(path)
    except InputError:
        return
    assert min(photo.width, photo.height) >= SIDE
    assert photo.camera is None or np.isfinite(photo.camera.matrix).all()


def read_record_bytes(data: bytes, _folder: Path) -> None:
    """A line of the record of a batch; whatever is accepted can be written, and names files of the folder alone."""
    row = parse_row(data)
    if row is None:
        return
    assert not any(Path(file).is_absolute() or ".." in Path(file).parts for file in (row.name, *row.outcome.files))
    assert parse_row(row_line(row)) is not None


def read_corrections_bytes(data: bytes, _folder: Path) -> None:
    """A corrections file; whatever is accepted can be written, and reads back as the same text."""
    try:
        corrections = corrections_from_json(data.decode("utf-8-sig", "surrogatepass"))
    except (InputError, UnicodeDecodeError):  # read_corrections reports text that is not UTF-8
        return
    text = corrections_to_json(corrections)
    assert corrections_to_json(corrections_from_json(text)) == text


def read_depth_bytes(data: bytes, folder: Path) -> None:
    """A depth map of any kind, laid onto a photo of another size."""
    path = folder / "map"
    path.write_bytes(data)
    refused = ""
    try:
        depth = read_depth_map(path)
        onto = map_to_photo(depth, Photo("photo", np.zeros((48, SIDE, 3), np.uint8), None))
    except InputError as error:
        refused = str(error)
    assert len(refused.splitlines()) <= 1
    if refused:
        return
    assert depth.valid.any()
    assert (onto.width, onto.height) == (SIDE, 48)


def read_fspy_bytes(data: bytes, folder: Path) -> None:
    """An fSpy project as a camera file."""
    path = folder / "camera.fspy"
    path.write_bytes(data)
    try:
        calibration = read_calibration(path)
    except InputError:
        return
    assert np.isfinite(calibration.square_matrix).all()


def read_fspy_state(data: bytes, folder: Path) -> None:
    """The JSON inside an fSpy project, without the header that random bytes never get right."""
    read_fspy_bytes(struct.pack("<4sIII", b"fspy", 1, len(data), 0) + data, folder)


def image_bytes(kind: str, mode: str = "RGB", **options: Any) -> bytes:
    """A photo of the smallest size with a few edges in it."""
    pixels = np.full((SIDE, SIDE), 200, np.uint8)
    pixels[10:40, 20:50] = 60
    pixels[:, 30] = np.arange(SIDE)
    image = Image.fromarray(pixels)
    image = Image.fromarray(pixels.astype(np.float32)) if mode == "F" else image.convert(mode)
    stream = io.BytesIO()
    image.save(stream, kind, **options)
    return stream.getvalue()


def image_seeds() -> Iterator[bytes]:
    """One small photo of each kind that is read."""
    exif = Image.Exif()
    exif[0x0112] = 6  # orientation: turned
    exif[0x010F], exif[0x0110], exif[0x0131] = "Apple", "iPhone XS", "GIMP 2.10"
    camera = {
        0x920A: 4.25,
        0xA405: 28,
        0xA002: SIDE,
        0xA003: SIDE,
        0xA20E: 300.0,
        0xA20F: 299.0,
        0xA210: 2,
        0xA404: 2.0,
    }
    exif.get_ifd(0x8769).update(camera)
    yield image_bytes("JPEG", exif=exif)
    yield image_bytes("JPEG", "CMYK", progressive=True, quality=30)
    yield image_bytes("JPEG", "L")
    yield image_bytes("PNG", exif=exif)
    for mode in ("L", "P", "RGBA", "LA", "1", "I;16"):
        yield image_bytes("PNG", mode)
    for compression in ("raw", "tiff_lzw", "tiff_adobe_deflate", "packbits", "jpeg"):
        yield image_bytes("TIFF", compression=compression)
    yield image_bytes("TIFF", "F")
    yield image_bytes("TIFF", "1", compression="group4")
    for kind in (
        "WEBP",
        "BMP",
        "GIF",
        "PPM",
        "TGA",
        "ICO",
        "JPEG2000",
        "PCX",
        "SGI",
        "DDS",
        "ICNS",
        "MSP",
        "XBM",
    ):
        yield image_bytes(kind, {"MSP": "1", "XBM": "1", "GIF": "P"}.get(kind, "RGB"))
    yield image_bytes("WEBP", "RGBA", lossless=True)
    yield b"PF\n64 64\n-1.0\n" + bytes(SIDE * SIDE * 12)
    yield b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n" + bytes([90, 90, 90, 128]) * (SIDE * SIDE)


def camera_seeds() -> Iterator[bytes]:
    """Camera files with and without distortion."""
    document = {"width": SIDE, "height": SIDE, "K": [[70.0, 0, 31.5], [0, 70.0, 31.5], [0, 0, 1]]}
    yield json.dumps(document).encode()
    for count in (4, 5, 8, 12, 14):
        coefficients = [0.01 * (-1) ** number / (number + 1) for number in range(count)]
        yield json.dumps({**document, "distortion": coefficients}).encode()
    yield json.dumps(
        {**document, "distortion": [[0.0, 0, 0, 0, 0]], "K": [[70, 0, 31], [0, 71, 31], [0, 0, 1]]}
    ).encode()


def record_seeds() -> Iterator[bytes]:
    """A photo that is done and one that failed."""
    figures = Figures(20, 30, 25, 4, 5, 0.01, "optimal", ("a note",))
    done = Outcome("done", "", 2.5, 1.25, 260.0, figures, {"facade.json": 1000, "thumbnails/facade.jpg": 200})
    yield row_line(Row("folder/facade.jpg", "0" * 64, "f" * 64, "facade", done, "2026-11-21T12:00:00+00:00"))
    failed = Outcome("failed", "too few lines")
    yield row_line(Row("other.jpg", "1" * 64, "f" * 64, "other", failed, "2026-11-21T12:00:00+00:00"))


def corrections_seeds() -> Iterator[bytes]:
    """One edit of every kind."""
    first = {"segment": [[10.0, 20.0], [300.5, 40.0]], "axis": "x"}
    second = {"segment": [[10.0, 20.0], [12.5, 240.0]], "axis": "z"}
    edits = [
        {"op": "label", "lines": [first, second], "pixel": [10.0, 20.0], "value": "real"},
        {"op": "label", "lines": [first, second], "pixel": [10.0, 20.0], "value": None},
        {"op": "axis", "line": first, "axis": "y"},
        {"op": "delete", "line": second},
        {"op": "split", "line": first, "at": [100.0, 26.0]},
        {"op": "join", "lines": [first, first]},
        {"op": "draw", "line": second},
        {"op": "length", "line": second, "metres": 2.5},
        {"op": "frame", "lines": [first, second]},
    ]
    head = {"format": "linecad-corrections", "version": 1, "photo": "facade.jpg", "width": 640, "height": 480}
    yield json.dumps({**head, "edits": edits, "undone": edits[:1]}).encode()


def fspy_states() -> Iterator[bytes]:
    """States with a focal length, with an angle alone, and without a camera."""
    camera = {
        "principalPoint": {"x": 0.01, "y": -0.02}, "relativeFocalLength": 1.5, "horizontalFieldOfView": 1.0,
        "imageWidth": SIDE, "imageHeight": 48,
    }  # fmt: skip
    yield json.dumps({"cameraParameters": camera}).encode()
    del camera["relativeFocalLength"]
    yield json.dumps({"cameraParameters": camera}).encode()
    yield json.dumps({"cameraParameters": None}).encode()


def fspy_seeds() -> Iterator[bytes]:
    """Whole projects, with a photo that is none."""
    for state in fspy_states():
        yield struct.pack("<4sIII", b"fspy", 1, len(state), 10) + state + b"0123456789"


def scene_seeds() -> Iterator[bytes]:
    """A scene of three lines, one crossing and one plane with a face and a hole."""
    square = [[0.0, 5.0, 0.0], [4.0, 5.0, 0.0], [4.0, 5.0, 3.0], [0.0, 5.0, 3.0]]
    hole = [[1.0, 5.0, 1.0], [2.0, 5.0, 1.0], [2.0, 5.0, 2.0]]
    names = ("x", "z", "y")
    document = {
        "format": "linecad-scene",
        "version": 1,
        "photo": "facade.jpg",
        "camera": {
            "width": 640,
            "height": 480,
            "K": [[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]],
            "distortion": [],
            "source": "exif",
            "R_cam_from_world": [[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]],
        },
        "metres_per_unit": None,
        "lines": [
            {
                "id": number, "axis": names[number], "segment": [[10.0 * number, 20.0], [30.0, 40.0]],
                "ends": [[0.0, 5.0, 0.0], [4.0, 5.0, float(number)]], "boundary": number == 1, "component": 0,
                "confidence": ("proven", "supported", "weak")[number],
            }
            for number in range(3)
        ],
        "intersections": [
            {"lines": [0, 1], "kind": "L", "pixel": [10.0, 20.0], "real": True, "in_tree": True, "weight": 1.1},
            {"lines": [1, 2], "kind": "T", "pixel": [10.5, 2.0], "real": False, "in_tree": False, "weight": 0.9},
        ],
        "planes": [
            {
                "id": 0, "axis": "y", "offset": 5.0, "lines": [0, 1],
                "faces": [{"id": 0, "outline": square, "holes": [hole]}],
            }
        ],
        "solve": {
            "solver": "SCIP 10.0", "formulation": "gain", "status": "optimal", "objective": 2.0, "bound": None,
            "gap": 0.0, "seconds": 0.1, "cuts": 2, "nodes": 1,
        },
        "notes": ["focal length guessed"],
    }  # fmt: skip
    yield json.dumps(document).encode()
    yield json.dumps({**document, "metres_per_unit": 0.5, "planes": [], "lines": [], "intersections": []}).encode()


TARGETS = {
    "scene": Target(read_scene_bytes, True, scene_seeds, 8192),
    "camera": Target(read_camera_bytes, True, camera_seeds, 2048),
    "corrections": Target(read_corrections_bytes, True, corrections_seeds, 8192),
    "fspy": Target(read_fspy_bytes, False, fspy_seeds, 2048),
    "fspystate": Target(read_fspy_state, True, fspy_states, 2048),
    "record": Target(read_record_bytes, True, record_seeds, 4096),
    "depth": Target(read_depth_bytes, False, depth_seeds, 32768),
    "image": Target(read_image_bytes, False, image_seeds, 32768),
}


def folder_in_memory() -> "tempfile.TemporaryDirectory[str]":
    """A folder for inputs, in memory where the system has such a place."""
    shared = Path("/dev/shm")
    return tempfile.TemporaryDirectory(prefix="linecad-fuzz-", dir=shared if shared.is_dir() else None)
