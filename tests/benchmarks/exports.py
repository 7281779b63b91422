"""Time and memory of every export: 2,000 lines and 500 faces with holes, one whole process a format.

    python tests/benchmarks/exports.py [--lines 2000] [--faces 500] [--keep FOLDER]

Time is the wall clock of `linecad export` and the time that it computed (all its threads), which says more on a busy
machine; memory is the largest resident set of that process. The goal is 3 s and 500 MB each, without textures.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from bare_scene import scene_of_lines
from PIL import Image

from exporters.format_options import TEXTURES
from exporters.formats import FORMATS
from linecad.io.scene_file import write_scene
from linecad.scene import Camera, Face, Lines, Plane, Scene

ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT, FOCAL = 3072, 2048, 2760.0  # px, as the photos of castle
CELL = 4.0  # m between the middles of two faces on a wall
COLUMNS = 25  # faces beside each other on a wall; the walls stand behind one another
DEPTH, BETWEEN = 40.0, 12.0  # m of the first wall, and from wall to wall


def made_scene(lines: int, faces: int) -> Scene:
    """Walls of square faces with a square hole each, before a camera that looks at them, and lines on them."""
    rotation = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    matrix = np.array([[FOCAL, 0, WIDTH / 2 + 3.2], [0, FOCAL, HEIGHT / 2 - 7.9], [0, 0, 1]])
    middles = np.array([((number % COLUMNS - COLUMNS // 2) * CELL, number // COLUMNS) for number in range(faces)])
    planes: dict[float, list[Face]] = {}
    for number, (x, row) in enumerate(middles):
        y, z = DEPTH + BETWEEN * (row // 5), (row % 5) * CELL
        outer, inner = (
            np.array([[x - r, y, z - r], [x + r, y, z - r], [x + r, y, z + r], [x - r, y, z + r]]) for r in (1.8, 0.7)
        )
        planes.setdefault(y, []).append(Face(number, outer, (inner,)))
    rng = np.random.default_rng(0)
    axis = rng.integers(0, 3, lines)
    start = rng.uniform([-40, DEPTH, -2], [40, DEPTH + 40, 18], (lines, 3))
    ends = np.stack([start, start + np.eye(3)[axis] * rng.uniform(0.3, 4, lines)[:, None]], axis=1)
    image = ends @ rotation.T @ matrix.T
    found = Lines(
        id=np.arange(lines),
        axis=axis,
        segment=image[..., :2] / image[..., 2:],
        ends=ends,
        is_boundary=rng.random(lines) < 0.4,
        component=np.zeros(lines, int),
        confidence=np.full(lines, "proven"),
    )
    walls = tuple(Plane(number, 1, y, (), tuple(held)) for number, (y, held) in enumerate(planes.items()))
    scene = scene_of_lines(Camera(WIDTH, HEIGHT, matrix, "file"), rotation, found)
    return replace(scene, planes=walls, metres_per_unit=1.0)


def measured(command: list[str]) -> tuple[float, float, float]:
    """Seconds on the clock, seconds of computing, and MiB of a command, which must succeed."""
    started = time.perf_counter()
    process = subprocess.Popen(command, cwd=ROOT)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - started
    if status != 0:
        raise SystemExit(f"{' '.join(command)} ended with {status}")
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def textured(suffix: str) -> bool:
    """Whether the format can hold textures."""
    return TEXTURES[0] in FORMATS[suffix].options


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--lines", type=int, default=2000)
    parser.add_argument("--faces", type=int, default=500)
    parser.add_argument("--runs", type=int, default=2, help="the best counts: the others measure their neighbours (2)")
    parser.add_argument("--keep", type=Path, help="write the files there and leave them")
    parsed = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) if parsed.keep is None else parsed.keep
        folder.mkdir(exist_ok=True)
        write_scene(made_scene(parsed.lines, parsed.faces), folder / "made.json")
        noise = np.random.default_rng(0).integers(0, 255, (HEIGHT // 8, WIDTH // 8, 3), np.uint8)
        Image.fromarray(noise).resize((WIDTH, HEIGHT)).save(folder / "made.jpg", quality=90)
        print(
            f"| {parsed.lines} lines, {parsed.faces} faces | s | s computing | MiB | file, KiB |\n"
            "| --- | --- | --- | --- | --- |"
        )
        plain = [(suffix, ["--option", "textures=off"] if textured(suffix) else []) for suffix in FORMATS]
        for suffix, options in plain + [(suffix, []) for suffix in FORMATS if textured(suffix)]:
            path = folder / f"made{suffix}"
            command = [sys.executable, "-m", "linecad", "export", str(folder / "made.json"), "-o", str(path), "--quiet"]
            command += options
            runs = [measured(command) for _ in range(parsed.runs)]
            seconds, computing = (min(run[column] for run in runs) for column in (0, 1))
            memory, size = max(run[2] for run in runs), path.stat().st_size / 1024
            name = f"`{suffix}`, textures" if textured(suffix) and not options else f"`{suffix}`"
            print(f"| {name} | {seconds:.2f} | {computing:.2f} | {memory:.0f} | {size:.0f} |", flush=True)


if __name__ == "__main__":
    main()
