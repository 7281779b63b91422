"""A scene as a file to download: the export itself, or a ZIP where other files lie beside it."""

import io
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exporters.options import Value
from linecad.outputs import write_outputs
from linecad.scene import Scene

ZIP = ".zip"
EPOCH = (1980, 1, 1, 0, 0, 0)  # the first that a ZIP can tell: the same model gives the same bytes


@dataclass(frozen=True)
class Download:
    """What a browser saves."""

    name: str
    data: bytes


def download_of(
    scene: Scene, pixels: NDArray[np.uint8], name: str, values: Mapping[str, Value] | None = None
) -> Download:
    """A scene in the format of the suffix of `name`, as `linecad export -o NAME` writes it.

    `pixels` (H, W, 3) RGB are those of its photo, `values` options of the format. LinecadError where it cannot be
    written.
    """
    with tempfile.TemporaryDirectory(prefix="linecad-") as folder:
        path = Path(folder) / name
        write_outputs(scene, pixels, [path], values or {})
        files = sorted(each for each in Path(folder).rglob("*") if each.is_file())
        if files == [path]:
            return Download(name, path.read_bytes())
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for each in files:
                member = zipfile.ZipInfo(each.relative_to(folder).as_posix(), EPOCH)
                member.external_attr = 0o644 << 16
                archive.writestr(member, each.read_bytes(), zipfile.ZIP_DEFLATED)
        return Download(name + ZIP, packed.getvalue())
