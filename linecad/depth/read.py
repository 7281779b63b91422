"""A depth map read from any of the files that networks and phones write, told apart by their first bytes."""

import contextlib
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from linecad.arrays import Float
from linecad.depth.arrays_in_files import NPY_MAGIC, ZIP_MAGIC
from linecad.depth.depth_map import MOST_BYTES, WHAT_TO_GIVE, Content, DepthMap, Reading, check_size
from linecad.depth.intrinsics import matrix_of_angles
from linecad.depth.normal_picture import read_normal_picture
from linecad.depth.normals import Normals
from linecad.depth.numpy_files import read_npy_depth, read_npz_depth
from linecad.depth.pfm import MAGICS as PFM_MAGICS
from linecad.depth.pfm import read_pfm
from linecad.depth.pictures import read_picture
from linecad.depth.validity import valid_depths
from linecad.errors import DepthMapError
from linecad.io import strict_json
from linecad.io.strict_json import JsonError

EXR_MAGIC = b"\x76\x2f\x31\x01"
HEIF_BOX = b"ftyp"  # from the fifth byte on
PICTURE_MAGICS = (b"\x89PNG", b"II*\0", b"MM\0*", b"\xff\xd8\xff", b"GIF8", b"BM", b"RIFF")
MISSING = {"OpenEXR": "OpenEXR files", "pillow_heif": "the depth in HEIC photos"}
# MoGe writes these into a folder of the photo; files of other names have nothing beside them.
STEMS_OF_A_FOLDER = ("depth", "points")
NORMAL_PICTURE, ANGLES = "normal.png", "fov.json"
LARGEST_ANGLES_FILE = 10_000  # bytes

Reader = Callable[[Path, Reading], Content]


def read_depth_map(path: Path, reading: Reading | None = None) -> DepthMap:
    """The depth map in a file, with what it and MoGe's files beside it tell of the camera and of normals.

    Raises DepthMapError where the file cannot be read, is damaged, or holds no depth that linecad could measure in.
    """
    path = Path(path)
    with _in_one_line(path):
        content = _reader(path)(path, reading or Reading())
        height, width = content.values.shape
        check_size(width, height, path)
        content = _with_files_beside(content, path)
        values, valid = valid_depths(content.values, content.mask)
        normals = None if content.normals is None else Normals(content.normals)
    if not valid.any():
        raise DepthMapError(f"{path} holds no depth: all its values are 0, negative or not finite; make it again")
    return DepthMap(path.name, values, valid, content.kind, content.intrinsics, normals)


def check_depth_file(path: Path) -> None:
    """Raise DepthMapError where the size and the first bytes of a file tell that `read_depth_map` will refuse it."""
    with _in_one_line(path):
        _reader(path)


def files_of_map(path: Path) -> list[Path]:
    """The files that are read for a map: itself, and what MoGe writes beside it, where that is there."""
    beside = [path.with_name(name) for name in (NORMAL_PICTURE, ANGLES)] if path.stem in STEMS_OF_A_FOLDER else []
    return [path, *(file for file in beside if file.is_file())]


@contextlib.contextmanager
def _in_one_line(path: Path) -> Iterator[None]:
    """Whatever the parsing of a file trips over becomes a DepthMapError."""
    try:
        yield
    except DepthMapError:
        raise
    except ImportError as error:
        library = str(error.name)
        raise DepthMapError(
            f"{path}: {MISSING.get(library, 'such files')} need the library {library}; "
            "pip install 'linecad[depth]', or give the depth as .npz"
        ) from error
    except MemoryError as error:
        raise DepthMapError(f"{path} does not fit into memory; scale it down first") from error
    except Exception as error:  # zipfile, zlib, Pillow, OpenEXR and libheif raise whatever their parsing trips over
        if isinstance(error, OSError) and error.errno is not None:
            raise DepthMapError(f"{path} cannot be read ({error.strerror}); check its permissions") from error
        reason = " ".join(str(error).split()) or type(error).__name__
        raise DepthMapError(f"{path} is damaged or incomplete ({reason}); copy it again, or save it again") from error


def _reader(path: Path) -> Reader:
    """What reads a file that starts with such bytes."""
    if not path.is_file():
        found = "does not exist" if not path.exists() else "is a folder" if path.is_dir() else "is not a file"
        raise DepthMapError(f"{path} {found}; give {WHAT_TO_GIVE}")
    size = path.stat().st_size
    if size == 0:
        raise DepthMapError(f"{path} is empty; copy it again")
    if size > MOST_BYTES:
        raise DepthMapError(f"{path} has {size / 1e9:.1f} GB, far more than a depth map; save the depth alone")
    with path.open("rb") as file:
        start = file.read(12)
    if start.startswith(ZIP_MAGIC):
        return read_npz_depth
    if start.startswith(NPY_MAGIC):
        return read_npy_depth
    if start.startswith(PFM_MAGICS):
        return read_pfm
    if start.startswith(PICTURE_MAGICS):
        return read_picture
    if start.startswith(EXR_MAGIC):
        from linecad.depth.exr import read_exr

        return read_exr
    if start[4:8] == HEIF_BOX:
        from linecad.depth.heic import read_heic

        return read_heic
    raise DepthMapError(
        f"{path} is not a depth map that linecad can read, or its start is damaged; give {WHAT_TO_GIVE}"
    )


def _with_files_beside(content: Content, path: Path) -> Content:
    """With the normals and the fields of view that MoGe writes beside depth.exr, where the depth has none itself."""
    if path.stem not in STEMS_OF_A_FOLDER:
        return content
    height, width = content.values.shape
    picture, angles = path.parent / NORMAL_PICTURE, path.parent / ANGLES
    if content.normals is None and picture.is_file():
        content = replace(content, normals=read_normal_picture(picture, width, height))
    if content.intrinsics is None and angles.is_file():
        content = replace(content, intrinsics=_matrix_beside(angles, width, height))
    return content


def _matrix_beside(path: Path, width: int, height: int) -> Float:
    """K in px of MoGe's fields of view, in degrees."""
    try:
        with path.open("rb") as file:
            record = strict_json.parse(file.read(LARGEST_ANGLES_FILE).decode())
        across, down = (record[key].number() for key in ("fov_x", "fov_y"))
    except (JsonError, UnicodeDecodeError) as error:
        raise DepthMapError(f"{path}: {error}; make it again with the depth, or move it away") from error
    if not (0 < across < 180 and 0 < down < 180):
        raise DepthMapError(f"{path} has fields of view of {across:g} and {down:g} degrees; make it again")
    return matrix_of_angles(math.radians(across), math.radians(down), width, height)
