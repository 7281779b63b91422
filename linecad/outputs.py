"""A scene to all the files that were asked for, each in the format that its suffix chooses."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from exporters.formats import export
from exporters.options import Value
from linecad.io.scene_file import write_scene
from linecad.scene import Scene

SCENE_SUFFIX = ".json"


def write_outputs(
    scene: Scene,
    pixels: NDArray[np.uint8] | None,
    outputs: Sequence[Path],
    values: Mapping[str, Value],
    on_stage: Callable[[str], None] | None = None,
) -> None:
    """Write a scene, each file whole or not at all. Raises OutputError.

    `pixels` (H, W, 3) RGB are those of its photo, for formats that show it; `values` are options of formats as
    exporters.formats reads them.
    """
    for path in outputs:
        if on_stage is not None:
            on_stage(f"writing {path}")
        if path.suffix.lower() == SCENE_SUFFIX:
            write_scene(scene, path)
        else:
            export(scene, path, pixels, values)
