"""Made scenes on disk: one folder a scene with its photo, camera and truth, and a list (docs/reference/datasets.md).

A folder appears whole or not at all: it is filled under a hidden name and then renamed.
"""

import json
import shutil
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float, Int
from linecad.dataset.modelling import halved, parallelograms
from linecad.dataset.truth import NOTHING, TrueFrames, TrueOpenings, Truth
from linecad.errors import DatasetError, OutputError
from linecad.io.files import write_atomically, write_text_atomically
from linecad.io.strict_json import JsonError, parse

LIST = "dataset.json"
PHOTO = "photo.jpg"
CAMERA = "camera.json"
TRUTH = "truth.npz"
DEPTH_MAP = "photo.depth.npz"  # by the photo's name, as `linecad batch` looks for it
FORMAT = "linecad-dataset"
VERSION = 1
OF_ALL_KINDS = "all"  # the source of datasets whose list names none: streets, courtyards and rooms
LARGEST_SIDE = 16384  # px
LARGEST_SEED = 2**32 - 1
LARGEST_TRUTH = 4_000_000_000  # bytes of all arrays; a file that claims more is not one of ours
SINGULAR = 1e-9  # determinant
LARGEST_LIST = 50_000_000  # bytes

# Shapes of the arrays of a truth; letters are lengths that must agree. The corners of a quad are three, for the fourth
# follows from them.
Shape = tuple[int | str, ...]
REAL_ARRAYS: dict[str, Shape] = {
    "matrix": (3, 3),
    "rotation": (3, 3),
    "corners": ("Q", 3, 3),
    "edges": ("M", 2, 3),
    "pieces": ("V", 2, 2),
}
WHOLE_ARRAYS: dict[str, Shape] = {
    "body": ("Q",),
    "edge_body": ("M",),
    "piece_edge": ("V",),
    "ids": ("H", "W"),
}
# Of windows and doors: all of them or, in files of earlier versions, none.
OPENING_ARRAYS: dict[str, Shape] = {
    "openings": ("O", 3, 3),
    "opening_is_door": ("O",),
    "opening_body": ("O",),
}
# Of scenes of several frames: all of them or none.
FRAME_ARRAYS: dict[str, Shape] = {
    "frames": ("F",),
    "quad_slope": ("Q",),
    "edge_slope": ("M",),
    "quad_frame": ("Q",),
    "edge_frame": ("M",),
    "triangles": ("T",),
}
REAL_NAMES = {*REAL_ARRAYS, "openings", "frames", "quad_slope", "edge_slope"}


@dataclass(frozen=True)
class DatasetList:
    """What dataset.json says."""

    seed: int
    width: int  # px
    height: int  # px
    samples: int  # a pixel
    scenes: tuple[str, ...]  # names of the folders that are there, in ascending order
    source: str = OF_ALL_KINDS  # what the scenes are drawn from


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
    if made.source != OF_ALL_KINDS:
        document["source"] = made.source
    text = json.dumps(document, indent=1) + "\n"
    write_text_atomically(folder / LIST, text)


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
        named = top.get("source")
        source = OF_ALL_KINDS if named is None else named.text()
    except (JsonError, UnicodeDecodeError, OSError) as error:
        raise DatasetError(f"{path} is not a list of scenes: {_reason(error)}; make the dataset again") from error
    for name in names:
        # A list does not send us to other folders.
        if not name or name in (".", "..") or Path(name).name != name or "\\" in name:
            raise DatasetError(f"{path} names the scene {name!r}, which is no name of a folder; make the dataset again")
    return DatasetList(seed, size[0], size[1], samples, tuple(names), source)


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
    write_text_atomically(folder / CAMERA, text)
    real = {
        "matrix": truth.matrix,
        "rotation": truth.rotation,
        "corners": truth.quads[:, [0, 1, 3]],
        "edges": truth.edges,
        "pieces": truth.pieces,
    }
    whole = {
        "version": np.array(VERSION),
        "body": truth.body,
        "edge_body": truth.edge_body,
        "piece_edge": truth.piece_edge,
        "ids": truth.ids,
    }
    if truth.openings is not None:
        real["openings"] = truth.openings.corners[:, [0, 1, 3]]
        whole["opening_is_door"] = truth.openings.is_door
        whole["opening_body"] = truth.openings.body
    if truth.frames is not None:
        real |= {"frames": truth.frames.turn, "quad_slope": truth.frames.quad_slope}
        real["edge_slope"] = truth.frames.edge_slope
        whole |= {"quad_frame": truth.frames.quad, "edge_frame": truth.frames.edge}
        whole["triangles"] = _triangles(truth.quads)
    arrays = real | {name: numbers.astype(np.int32) for name, numbers in whole.items()}
    write_atomically(folder / TRUTH, lambda path: _write_arrays(path, arrays))


def write_depth_map(arrays: dict[str, NDArray[Any]], path: Path) -> None:
    """Write an .npz in the place of what was there; the same arrays give the same bytes. Raises OutputError."""
    write_atomically(path, lambda unfinished: _write_arrays(unfinished, arrays))


def read_truth(folder: Path) -> Truth:
    """The truth of the scene in `folder`, checked. Raises DatasetError."""
    path = folder / TRUTH
    if not path.is_file():
        raise DatasetError(f"{folder} holds no {TRUTH}; it is not a scene that `linecad dataset` made")
    try:
        real, whole = _read_arrays(path)
        _check(real, whole)
    except (OSError, EOFError, ValueError, KeyError, MemoryError, zipfile.BadZipFile, zlib.error) as error:
        raise DatasetError(f"{path} cannot be read: {_reason(error)}; make the scene again") from error
    height, width = whole["ids"].shape
    return Truth(
        name=folder.name,
        width=width,
        height=height,
        matrix=real["matrix"],
        rotation=real["rotation"],
        quads=halved(parallelograms(real["corners"]), whole.get("triangles", np.zeros(0, np.int64))),
        body=whole["body"],
        edges=real["edges"],
        edge_body=whole["edge_body"],
        pieces=real["pieces"],
        piece_edge=whole["piece_edge"],
        ids=whole["ids"],
        openings=_openings(real, whole),
        frames=_frames(real, whole),
    )


def _triangles(quads: Float) -> Int:
    """The quads (T,) whose third corner lies between its neighbours."""
    beyond = quads[:, 2] - (quads[:, 1] + quads[:, 3]) / 2
    half = np.linalg.norm(quads[:, 1] + quads[:, 3] - 2 * quads[:, 0], axis=1) / 2
    triangles: Int = np.flatnonzero(np.linalg.norm(beyond, axis=1) < half / 2)
    return triangles


def _frames(real: dict[str, Float], whole: dict[str, Int]) -> TrueFrames | None:
    if "frames" not in real:
        return None
    return TrueFrames(real["frames"], whole["quad_frame"], real["quad_slope"], whole["edge_frame"], real["edge_slope"])


def _openings(real: dict[str, Float], whole: dict[str, Int]) -> TrueOpenings | None:
    if "openings" not in real:
        return None
    return TrueOpenings(parallelograms(real["openings"]), whole["opening_is_door"] == 1, whole["opening_body"])


def _read_arrays(path: Path) -> tuple[dict[str, Float], dict[str, Int]]:
    """The arrays of a truth by name. Raises ValueError, KeyError, or what a damaged archive raises."""
    with zipfile.ZipFile(path) as archive:
        if sum(member.file_size for member in archive.infolist()) > LARGEST_TRUTH:
            raise ValueError("it claims to hold more than a scene can")
    with np.load(path, allow_pickle=False) as found:
        version = int(found["version"])
        if version != VERSION:
            raise ValueError(f"its version is {version}, this linecad reads {VERSION}")
        names = [*REAL_ARRAYS, *WHOLE_ARRAYS]
        for optional in (OPENING_ARRAYS, FRAME_ARRAYS):
            names += optional if set(optional) & set(found.files) else ()
        real = {name: _of_kind(found[name], "f", name).astype(np.float64) for name in names if name in REAL_NAMES}
        whole = {name: _of_kind(found[name], "i", name).astype(np.int64) for name in names if name not in REAL_NAMES}
    return real, whole


def _of_kind(array: NDArray[Any], kind: str, name: str) -> NDArray[Any]:
    if array.dtype.kind != kind:
        raise ValueError(f"{name} holds numbers of the wrong kind")
    return array


def _check(real: dict[str, Float], whole: dict[str, Int]) -> None:
    """Raise ValueError where shapes, indices or numbers are not what a truth has."""
    lengths: dict[str, int] = {}
    told = OPENING_ARRAYS if "openings" in real else {}
    told = told | (FRAME_ARRAYS if "frames" in real else {})
    for name, shape in (REAL_ARRAYS | WHOLE_ARRAYS | told).items():
        found = (real[name] if name in real else whole[name]).shape
        wanted = [
            length if isinstance(length, int) else lengths.setdefault(length, have)
            for length, have in zip(shape, found, strict=False)
        ]
        if len(found) != len(shape) or list(found) != wanted:
            raise ValueError(f"{name} has the wrong shape")
    if not 1 <= min(lengths["H"], lengths["W"]) <= max(lengths["H"], lengths["W"]) <= LARGEST_SIDE:
        raise ValueError("its map has no size that a photo has")
    for name, numbers in real.items():
        if not np.isfinite(numbers).all():
            raise ValueError(f"{name} holds a number that is not finite")
    bodies = int(whole["body"].max(initial=-1)) + 1
    limits = {
        "ids": (NOTHING, lengths["Q"]),
        "piece_edge": (0, lengths["M"]),
        "body": (0, bodies),
        "edge_body": (0, bodies),
    }
    if "frames" in real:
        limits |= dict.fromkeys(("quad_frame", "edge_frame"), (NOTHING, lengths["F"]))
        limits["triangles"] = (0, lengths["Q"])
    if "openings" in real:
        limits |= {"opening_is_door": (0, 2), "opening_body": (0, bodies)}
    for name, (low, high) in limits.items():
        named = whole[name]
        if named.size and not low <= named.min() <= named.max() < high:
            raise ValueError(f"{name} names what is not there")
    for name in ("matrix", "rotation"):
        if abs(np.linalg.det(real[name])) < SINGULAR:
            raise ValueError(f"{name} cannot be inverted")


def _write_arrays(path: Path, arrays: dict[str, Any]) -> None:
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays)


def _reason(error: BaseException) -> str:
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return " ".join(text.split()) or type(error).__name__
