"""York Urban as it is published: MATLAB files (Denis, Elder and Estrada, ECCV 2008).

`cameraParameters.mat` holds `focal`, `pixelSize` (both mm) and the principal point `pp` (px, the first pixel being 1).
`NAME/NAMELinesAndVP.mat` holds `lines`, two rows of x and y per line, and `vp_association`, 1 to 3 per line.
`NAME/NAMEGroundTruthVP_Orthogonal_CamParams.mat` holds `vp_orthogonal`, a unit direction per column, y pointing up;
older copies have it in the file of the lines.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from linecad.arrays import Float, Int
from linecad.errors import DatasetError
from linecad.evaluation.datasets import YORK_CAMERA, YORK_LINES

DIRECTIONS = "GroundTruthVP_Orthogonal_CamParams.mat"
FROM_ONE = 1.0  # px: MATLAB counts pixels from 1
Y_DOWN = np.array([1.0, -1.0, 1.0])
ORTHOGONAL = 0.01  # largest product of two unit directions that rounding explains


@dataclass(frozen=True, eq=False)
class York:
    """The truth about one photo of York Urban; pixels are counted from 0."""

    matrix: Float  # (3, 3) K, px
    directions: Float  # (3, 3) columns are the axes of label 1, 2, 3 in the camera frame, of free sign
    ends: Float  # (N, 2, 2) px
    axis: Int  # (N,) column of `directions`


def read_york(folder: Path, name: str) -> York:
    """The truth in the folder of one photo; DatasetError when a file is missing or does not hold what it should."""
    camera = _load(folder.parent / YORK_CAMERA)
    focal_mm, pixel_mm = _array(camera, "focal", 1)[0], _array(camera, "pixelSize", 1)[0]
    centre = _array(camera, "pp", 2) - FROM_ONE
    if not (focal_mm > 0 and pixel_mm > 0):
        raise DatasetError(
            f"{folder.parent / YORK_CAMERA} gives a focal length of {focal_mm:g} mm and pixels of {pixel_mm:g} mm; "
            "download it again"
        )
    focal = focal_mm / pixel_mm
    lines_file = folder / f"{name}{YORK_LINES}"
    lines = _load(lines_file)
    ends = _array(lines, "lines", None)
    label = _array(lines, "vp_association", None)
    if ends.size != 4 * label.size:
        raise DatasetError(
            f"{lines_file} holds {ends.size // 4} lines and {label.size} labels; download the dataset again"
        )
    if not np.isin(label, [1, 2, 3]).all():
        raise DatasetError(f"{lines_file} holds a label other than 1, 2 and 3; download the dataset again")
    other = folder / f"{name}{DIRECTIONS}"
    directions = _array(_load(other) if other.is_file() else lines, "vp_orthogonal", 9).reshape(3, 3)
    directions = Y_DOWN[:, None] * directions / np.linalg.norm(directions, axis=0)
    if not np.abs(directions.T @ directions - np.eye(3)).max() < ORTHOGONAL:
        raise DatasetError(f"the directions of {name} in {folder} are not orthogonal; download the dataset again")
    return York(
        matrix=np.array([[focal, 0.0, centre[0]], [0.0, focal, centre[1]], [0.0, 0.0, 1.0]]),
        directions=directions,
        ends=ends.reshape(-1, 2, 2) - FROM_ONE,
        axis=label.astype(np.int64) - 1,
    )


def _load(path: Path) -> dict[str, Any]:
    try:
        found: dict[str, Any] = loadmat(path)
    except OSError as error:
        raise DatasetError(f"{path} cannot be read: {error.strerror or error}; check the dataset") from error
    except (MatReadError, ValueError, TypeError, NotImplementedError) as error:
        raise DatasetError(f"{path} is no MATLAB file that can be read; download the dataset again") from error
    return {**found, _PATH: path}


_PATH = "__path__"


def _array(content: dict[str, Any], name: str, size: int | None) -> Float:
    """The numbers of a variable (M,), row by row."""
    if name not in content:
        raise DatasetError(f"{content[_PATH]} has no variable '{name}'; download the dataset again")
    try:
        found = np.asarray(content[name], np.float64).ravel()
    except (TypeError, ValueError) as error:
        raise DatasetError(f"'{name}' in {content[_PATH]} is not made of numbers; download it again") from error
    if size is not None and found.size != size:
        raise DatasetError(f"'{name}' in {content[_PATH]} has {found.size} numbers, expected {size}; download it again")
    if not np.isfinite(found).all():
        raise DatasetError(f"'{name}' in {content[_PATH]} has numbers that are not finite; download it again")
    return found
