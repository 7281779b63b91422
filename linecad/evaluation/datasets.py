"""Which photos a dataset folder holds, and of which of the known formats it is (docs/reference/evaluation.md)."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, Self

from linecad.dataset.store import LIST, PHOTO, read_list
from linecad.depth.beside import find_maps
from linecad.depth.read import files_of_map
from linecad.errors import DatasetError
from linecad.io import strict_json as strictjson
from linecad.io.strict_json import JsonError, Node

Kind = Literal["made", "york", "york-json", "points", "lines", "labels"]

YORK_CAMERA = "cameraParameters.mat"
YORK_LINES = "LinesAndVP.mat"
TRUTH_SUFFIX = ".truth"  # of the name of a file, before .json: its camera file and photo have the name without it
PHOTO_SUFFIXES = (".jpg", ".jpeg", ".png", ".tif", ".tiff", ".JPG", ".JPEG", ".PNG")
FILE_LIMIT = 100_000_000  # bytes
LABELS_FORMAT = "linecad-labels"
KNOWN = (
    f"known are: our own ({LIST}), York Urban ({YORK_CAMERA} and NAME/NAME{YORK_LINES}, or its JSON), points with "
    "depth, lines with crossings, and labels made by hand"
)


@dataclass(frozen=True)
class Case:
    """One photo of a dataset and where its truth lies."""

    name: str
    kind: Kind
    photo: Path
    truth: Path  # a file, or the folder of a made photo or of one of York Urban
    camera: Path | None = None  # a camera file beside the truth, whose pixels are then those of the undistorted photo
    depth: Path | None = None  # a depth map beside the photo, to be measured with

    @property
    def files(self) -> list[Path]:
        """Everything that is read."""
        maps = [] if self.depth is None else files_of_map(self.depth)
        return [path for path in (self.photo, self.truth, self.camera, *maps) if path is not None]


@dataclass(frozen=True)
class Dataset:
    """The photos of a dataset, in the order of their names (of a made one: in its own order)."""

    name: str
    cases: tuple[Case, ...]

    def with_depth_maps(self) -> Self:
        """With the depth maps that lie beside the photos. Raises DepthMapError where there is not one."""
        maps = find_maps([case.photo for case in self.cases])
        return replace(self, cases=tuple(replace(case, depth=maps.get(case.photo)) for case in self.cases))


def find_dataset(folder: Path) -> Dataset:
    """The dataset in a folder; DatasetError when there is none, or one that is not known or damaged."""
    if not folder.is_dir():
        raise DatasetError(f"{folder} is not a folder; give the folder of a dataset ({KNOWN})")
    if (folder / LIST).is_file():
        cases: Iterable[Case] = _made(folder)
    elif (folder / YORK_CAMERA).is_file():
        cases = _york(folder)
    else:
        cases = _by_json(folder)
    found = tuple(cases)
    if not found:
        raise DatasetError(f"no dataset was found in {folder}; {KNOWN}")
    return Dataset(folder.resolve().name, found)


def read_json(path: Path) -> Node:
    """The JSON in a file; DatasetError when it cannot be read or is none."""
    try:
        if path.stat().st_size > FILE_LIMIT:
            raise DatasetError(f"{path} has more than {FILE_LIMIT // 10**6} MB; it is no file of a dataset")
        return strictjson.parse(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise DatasetError(f"{path} cannot be read: {error.strerror}; check the dataset") from error
    except UnicodeDecodeError as error:
        raise DatasetError(f"{path} is not UTF-8; save it as UTF-8") from error
    except JsonError as error:
        raise DatasetError(f"{path}: {error}; check the dataset") from error


def _made(folder: Path) -> Iterable[Case]:
    for name in read_list(folder).scenes:
        yield Case(name, "made", folder / name / PHOTO, folder / name)


def _york(folder: Path) -> Iterable[Case]:
    for lines in sorted(folder.glob(f"*/*{YORK_LINES}")):
        name = lines.name.removesuffix(YORK_LINES)
        yield Case(name, "york", _photo(lines.with_name(name)), lines.parent)


def _by_json(folder: Path) -> Iterable[Case]:
    for path in sorted(folder.glob("*.json")):
        kind = _kind_of(read_json(path))
        if kind is None:
            continue  # a camera file, a scene
        name = path.stem.removesuffix(TRUTH_SUFFIX)
        if kind == "labels":
            yield Case(path.stem, kind, _labelled_photo(path), path)
        elif name != path.stem:
            yield Case(name, kind, _photo(path.with_name(name)), path, path.with_name(f"{name}.json"))
        else:
            yield Case(name, kind, _photo(path.with_name(name)), path)


def _kind_of(top: Node) -> Kind | None:
    """What a JSON file holds, by its keys; None for anything that is no truth."""
    if not isinstance(top.value, dict):
        return None
    keys = top.value.keys()
    if top.value.get("format") == LABELS_FORMAT:
        return "labels"
    if keys >= {"lines", "vp_dirs_orthogonal", "K"}:
        return "york-json"
    if keys >= {"points", "K"}:
        return "points"
    if keys >= {"lines", "crossings", "K"}:
        return "lines"
    return None


def _labelled_photo(path: Path) -> Path:
    try:
        name = read_json(path)["photo"].text()
    except JsonError as error:
        raise DatasetError(f"{path}: {error}; see docs/reference/evaluation.md") from error
    if Path(name).is_absolute() or ".." in Path(name).parts:
        raise DatasetError(f"{path} names the photo {name!r}; put the photo beside the labels and name it alone")
    return path.parent / name


def _photo(stem: Path) -> Path:
    """The photo of this name, whatever its suffix; the JPEG that should be there when there is none."""
    found = [stem.with_name(stem.name + suffix) for suffix in PHOTO_SUFFIXES]
    return next((path for path in found if path.is_file()), found[0])
