"""Sloped planes of made towns against the truth: python tests/benchmarks/roofs.py DATASET [--make N] [PHOTO ...]

DATASET holds towns; with --make it is made first, of the N first towns of SEED that show a sloped plane on more than
LEAST of the photo. For each town the true sloped planes that are seen so, and of these how many have a slope found
within 2 degrees, and a face whose depth is within 5 % of theirs in the median, at one scale for the whole photo; and of
all slopes that were found how many cover mostly such a plane, however small. Other arguments are photos whose slopes
are told: of those without roofs there should be none.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from linecad.arrays import Bool, Float
from linecad.camera.distortion import open_photo
from linecad.dataset.make import JUDGED_SIZE, DatasetOptions, Plan, draw_draft, make_dataset, measure, scene_name
from linecad.dataset.store import read_truth
from linecad.dataset.truth import NOTHING, Truth
from linecad.directions import components
from linecad.geometry import depths_beside, project, world_rays
from linecad.options import Options
from linecad.pipeline import reconstruct
from linecad.scene import Face, Scene

SEED = 90
SIZE, SAMPLES = (1280, 720), 8
LEAST = 0.01  # of the photo
FLATTEST, STEEPEST = np.radians(8.0), np.radians(80.0)
SAME_NORMAL, SAME_OFFSET = np.cos(np.radians(0.5)), 0.005  # of quads in one plane; m
SHOWN, SAMPLED = 0.5, 400  # share of a true roof that its face covers, of so many of its pixels
RIGHT_ANGLE, RIGHT_DEPTH = np.radians(2.0), 0.05


@dataclass(frozen=True, eq=False)
class TrueRoof:
    """A sloped plane of the truth and where the photo shows it."""

    normal: Float  # (3,) in the truth's world
    offset: float  # m
    shown: Bool  # (H, W)

    @property
    def share(self) -> float:
        """Of the photo."""
        return float(self.shown.mean())


def true_roofs(truth: Truth) -> list[TrueRoof]:
    """The sloped planes that are seen on more than LEAST of a photo, quads of one plane joined."""
    assert truth.frames is not None
    normal, offset = truth.planes()
    slope = truth.frames.quad_slope
    shown = np.bincount(truth.ids[truth.ids != NOTHING].ravel(), minlength=len(offset))
    left = (shown > 0) & (slope > FLATTEST) & (slope < STEEPEST)
    found = []
    for quad in np.argsort(-shown, kind="stable").tolist():
        if not left[quad]:
            continue
        turn = normal @ normal[quad]
        same = left & (np.abs(turn) > SAME_NORMAL) & (np.abs(offset * np.sign(turn) - offset[quad]) < SAME_OFFSET)
        same[quad] = True
        left &= ~same
        found.append(TrueRoof(normal[quad], float(offset[quad]), np.isin(truth.ids, np.flatnonzero(same))))
    return [roof for roof in found if roof.share > LEAST]


def make(folder: Path, count: int) -> None:
    """Make the towns."""
    options = DatasetOptions(count, SEED, *SIZE, SAMPLES)
    shown: list[int] = []
    index = 0
    while len(shown) < count:
        draft = draw_draft(SEED, index, "town")
        if true_roofs(measure(draft, *JUDGED_SIZE)):
            shown.append(index)
        index += 1
    names = tuple(scene_name(each, "town") for each in shown)
    make_dataset(folder, options, print, Plan(names, lambda place: draw_draft(SEED, shown[place], "town"), "town"))


def found_scene(photo_path: Path, camera: Path | None) -> Scene:
    """What the program makes of a photo."""
    return reconstruct(open_photo(photo_path, camera, None), Options(roofs=True))


def scale_of(scene: Scene, truth: Truth) -> float:
    """Found over true depth: the median over the lines of component 0, at the middles of their segments."""
    own = scene.lines.component == 0
    pixels = scene.lines.segment[own].mean(axis=1)
    rays = world_rays(pixels, scene.camera.matrix, scene.rotation)
    found = depths_beside(
        components(rays, scene.turns), components(scene.lines.ends[own, 0], scene.turns), scene.lines.axis[own]
    )
    return float(np.nanmedian(found / truth.quad_depth(pixels, truth.quad_at(pixels))))


def compare(scene: Scene, truth: Truth) -> tuple[list[tuple[float, bool, bool, bool]], list[bool]]:
    """Share of the photo, whether a face shows it, is right in angle, and in place too, of each true roof.

    And of each slope that was found whether most of it is one.

    The face of a true roof is the one that covers most of it.
    """
    scale = scale_of(scene, truth)
    sloped = [(plane, face) for plane, face in scene.faces if plane.tilt]
    rows = []
    for roof in true_roofs(truth):
        row, column = np.nonzero(roof.shown)
        pixels = np.column_stack([column, row])[:: max(len(row) // SAMPLED, 1)].astype(np.float64)
        rays = world_rays(pixels, scene.camera.matrix, scene.rotation)
        covers = [shapely.contains_xy(_in_photo(scene, face), *pixels.T).mean() for _, face in sloped]
        if not covers or max(covers) < SHOWN:
            rows.append((roof.share, False, False, False))
            continue
        plane = sloped[int(np.argmax(covers))][0]
        level = np.eye(3)[2]
        angle = abs(float(np.arccos(abs(plane.normal(scene.turns) @ level)) - np.arccos(abs(roof.normal @ level))))
        depth = plane.offset / plane.along_normal(rays, scene.turns) / scale
        true = roof.offset / (truth.rays(pixels) @ roof.normal)
        off = float(np.median(np.abs(depth / true - 1)))
        print(f"  share {roof.share:.3f}: angle off {np.degrees(angle):.1f} degrees, depth off {off:.1%}")
        rows.append((roof.share, True, angle < RIGHT_ANGLE, angle < RIGHT_ANGLE and off < RIGHT_DEPTH))
    return rows, [_is_true(_in_photo(scene, face), truth) for _, face in sloped]


def _is_true(shape: shapely.Polygon, truth: Truth) -> bool:
    """Whether most pixels of a shape, px, show a sloped plane."""
    assert truth.frames is not None
    low, high = np.array(shape.bounds).reshape(2, 2)
    size = [truth.width - 1, truth.height - 1]
    grid = np.meshgrid(
        *(np.arange(*each) for each in zip(np.clip(low, 0, size), np.clip(high, 0, size) + 1, strict=True))
    )
    pixels = np.stack(grid, axis=-1).reshape(-1, 2).astype(np.int64)
    number = truth.ids[tuple(pixels[shapely.contains_xy(shape, *pixels.T)].T[::-1])]
    slope = np.where(number == NOTHING, 0.0, truth.frames.quad_slope[number])
    return bool(((slope > FLATTEST) & (slope < STEEPEST)).sum() > SHOWN * len(slope))


def _in_photo(scene: Scene, face: Face) -> shapely.Polygon:
    return shapely.Polygon(project(face.outline, scene.camera.matrix, scene.rotation))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("photos", nargs="*", type=Path)
    parser.add_argument("--make", type=int, metavar="N")
    arguments = parser.parse_args()
    if arguments.make:
        make(arguments.dataset, arguments.make)
    rows, are_true = [], list[bool]()
    for folder in sorted(path.parent for path in arguments.dataset.glob("*/truth.npz")):
        truth = read_truth(folder)
        if truth.frames is None:
            parser.error(f"{folder} is no town; give a dataset of linecad dataset --towns")
        scene = found_scene(folder / "photo.jpg", folder / "camera.json")
        of_town, found = compare(scene, truth)
        print(
            f"{folder.name}: {len(of_town)} true, {len(found)} found, right {sum(row[3] for row in of_town)}",
            flush=True,
        )
        rows += of_town
        are_true += found
    if rows:
        shown, angle, right = (sum(row[place] for row in rows) for place in (1, 2, 3))
        print(f"of {len(rows)} sloped planes {shown} shown, {angle} at their angle, {right} in place")
        print(f"{len(are_true)} found, of which {sum(are_true)} are sloped")
    for path in arguments.photos:
        scene = found_scene(path, path.with_suffix(".json") if path.with_suffix(".json").exists() else None)
        slopes = [f"{np.degrees(abs(np.pi / 2 - plane.tilt)):.1f}" for plane in scene.planes if plane.tilt]
        print(f"{path.name}: {len(slopes)} sloped planes {' '.join(slopes)}", flush=True)


if __name__ == "__main__":
    main()
