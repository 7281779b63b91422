"""Made scenes on disk: one folder a scene with its photo, camera and truth, and a list of them (docs/dataset.md).

A folder appears whole or not at all: it is filled under a hidden name and then renamed.
"""

import json
import shutil
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from linecad.dataset.modelling import parallelograms
from linecad.dataset.truth import NOTHING, Truth
from linecad.errors import DatasetError, OutputError
from linecad.files import write_atomically
from linecad.scene import Float, Int
from linecad.strictjson import JsonError, parse

LIST = "dataset.json"
PHOTO = "photo.jpg"
CAMERA = "camera.json"
TRUTH = "truth.npz"
FORMAT = "linecad-dataset"
VERSION = 1
LARGEST_SIDE = 16384  # px
LARGEST_SEED = 2**32 - 1
LARGEST_TRUTH = 4_000_000_000  # bytes of all arrays; a file that claims more is not one of ours
LARGEST_LIST = 50_000_000  # bytes

# Name, kind of number and shape of each array; letters are lengths that must agree, and the corners of a quad are
# three, for the fourth follows from them.
ARRAYS: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "matrix": ("f", (3, 3)),
    "rotation": ("f", (3, 3)),
    "corners": ("f", ("Q", 3, 3)),
    "body": ("i", ("Q",)),
    "edges": ("f", ("M", 2, 3)),
    "edge_body": ("i", ("M",)),
    "pieces": ("f", ("V", 2, 2)),
    "piece_edge": ("i", ("V",)),
    "ids": ("i", ("H", "W")),
}


@dataclass(frozen=True)
class DatasetList:
    """What dataset.json says."""

    seed: int
    width: int  # px
    height: int  # px
    samples: int  # a pixel
    scenes: tuple[str, ...]  # names of the folders that are there, in ascending order


def write_list(made: DatasetList, folder: Path) -> None:
    """Write dataset.json. Raises OutputError."""
    document = {
        "format": FORMAT,
        "version": VERSION,
        "seed": made.seed,
        "size": [made.width, made.height],
        "samples": made.samples,
        "scenes": list(made.scenes),
    }
    text = json.dumps(document, indent=1) + "\n"
    write_atomically(folder / LIST, lambda path: _write_text(path, text))


def read_list(folder: Path) -> DatasetList:
    """What the dataset in `folder` holds. Raises DatasetError."""
    path = folder / LIST
    if not path.is_file():
        raise DatasetError(f"{folder} holds no {LIST}; give a folder that `linecad dataset` made")
    try:
        if path.stat().st_size > LARGEST_LIST:
            raise DatasetError(f"{path} is too large for a list of scenes; make the dataset again")
        top = parse(path.read_text(encoding="utf-8"))
        top["format"].one_of((FORMAT,))
        top["version"].integer(VERSION, VERSION)
        size = [side.integer(1, LARGEST_SIDE) for side in top["size"].items()]
        if len(size) != 2:
            raise top["size"].wrong("a list of 2")
        names = [name.text() for name in top["scenes"].items()]
        samples = top["samples"].integer(1)
        seed = top["seed"].integer(0, LARGEST_SEED)
    except (JsonError, UnicodeDecodeError, OSError) as error:
        raise DatasetError(f"{path} is not a list of scenes: {_reason(error)}; make the dataset again") from error
    for name in names:
        # A list does not send us to other folders.
        if not name or name in (".", "..") or Path(name).name != name or "\\" in name:
            raise DatasetError(f"{path} names the scene {name!r}, which is no name of a folder; make the dataset again")
    return DatasetList(seed, size[0], size[1], samples, tuple(names))


def write_scene_folder(folder: Path, truth: Truth, write_photo: Callable[[Path], None]) -> None:
    """Make the folder of a scene in the dataset `folder`, whole or not at all. Raises OutputError."""
    target, temporary = folder / truth.name, folder / f".linecad-{truth.name}"
    try:
        shutil.rmtree(temporary, ignore_errors=True)  # what a run that was killed left behind
        temporary.mkdir()
        try:
            write_photo(temporary / PHOTO)
            write_truth(truth, temporary)
            temporary.rename(target)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    except OSError as error:
        raise OutputError(
            f"{target} was not written: {_reason(error)}; check the disk or choose another folder"
        ) from error


def write_truth(truth: Truth, folder: Path) -> None:
    """Write camera.json and truth.npz of a scene. Raises OSError, or OutputError."""
    camera = {"width": truth.width, "height": truth.height, "K": truth.matrix.tolist()}
    text = json.dumps(camera) + "\n"
    write_atomically(folder / CAMERA, lambda path: _write_text(path, text))
    arrays = {
        "version": np.int64(VERSION),
        "matrix": truth.matrix,
        "rotation": truth.rotation,
        "corners": truth.quads[:, [0, 1, 3]],
        "body": truth.body.astype(np.int32),
        "edges": truth.edges,
        "edge_body": truth.edge_body.astype(np.int32),
        "pieces": truth.pieces,
        "piece_edge": truth.piece_edge.astype(np.int32),
        "ids": truth.ids.astype(np.int32),
    }
    write_atomically(folder / TRUTH, lambda path: _write_arrays(path, arrays))


def read_truth(folder: Path) -> Truth:
    """The truth of the scene in `folder`, checked. Raises DatasetError."""
    path = folder / TRUTH
    if not path.is_file():
        raise DatasetError(f"{folder} holds no {TRUTH}; it is not a scene that `linecad dataset` made")
    try:
        arrays = _read_arrays(path)
        _check(arrays)
    except (OSError, EOFError, ValueError, KeyError, MemoryError, zipfile.BadZipFile, zlib.error) as error:
        raise DatasetError(f"{path} cannot be read: {_reason(error)}; make the scene again") from error
    height, width = arrays["ids"].shape
    return Truth(
        name=folder.name,
        width=width,
        height=height,
        matrix=arrays["matrix"],
        rotation=arrays["rotation"],
        quads=parallelograms(arrays["corners"]),
        body=arrays["body"],
        edges=arrays["edges"],
        edge_body=arrays["edge_body"],
        pieces=arrays["pieces"],
        piece_edge=arrays["piece_edge"],
        ids=arrays["ids"],
    )


def _read_arrays(path: Path) -> dict[str, NDArray[np.float64] | NDArray[np.int64]]:
    with zipfile.ZipFile(path) as archive:
        if sum(member.file_size for member in archive.infolist()) > LARGEST_TRUTH:
            raise ValueError("it claims to hold more than a scene can")
    found: dict[str, Float | Int] = {}
    with np.load(path, allow_pickle=False) as archive:
        if int(archive["version"]) != VERSION:
            raise ValueError(f"its version is {int(archive['version'])}, this linecad reads {VERSION}")
        for name, (kind, _) in ARRAYS.items():
            array = archive[name]
            if array.dtype.kind != kind:
                raise ValueError(f"{name} holds numbers of the wrong kind")
            found[name] = array.astype(np.float64 if kind == "f" else np.int64)
    return found


def _check(arrays: dict[str, Float | Int]) -> None:
    """Raise ValueError where shapes, indices or numbers are not what a truth has."""
    lengths: dict[str, int] = {}
    for name, (kind, shape) in ARRAYS.items():
        array = arrays[name]
        fits = array.ndim == len(shape) and all(
            have == (want if isinstance(want, int) else lengths.setdefault(want, have))
            for have, want in zip(array.shape, shape, strict=True)
        )
        if not fits:
            raise ValueError(f"{name} has the wrong shape")
        if kind == "f" and not np.isfinite(array).all():
            raise ValueError(f"{name} holds a number that is not finite")
    limits = {
        "ids": (NOTHING, lengths["Q"]),
        "piece_edge": (0, lengths["M"]),
        "body": (0, None),
        "edge_body": (0, None),
    }
    for name, (low, high) in limits.items():
        array = arrays[name]
        if array.size and (array.min() < low or (high is not None and array.max() >= high)):
            raise ValueError(f"{name} names what is not there")
    if not 1 <= min(lengths["H"], lengths["W"]) <= max(lengths["H"], lengths["W"]) <= LARGEST_SIDE:
        raise ValueError("its map has no size that a photo has")
    for name in ("matrix", "rotation"):
        if abs(np.linalg.det(arrays[name])) < 1e-9:
            raise ValueError(f"{name} cannot be inverted")


def _write_text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def _write_arrays(path: Path, arrays: dict[str, NDArray[np.float64]]) -> None:
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays)


def _reason(error: BaseException) -> str:
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return " ".join(text.split()) or type(error).__name__
