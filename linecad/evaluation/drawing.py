"""All that is counted of a scene as a drawing, in one record."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool
from linecad.evaluation.depth import face_depths
from linecad.evaluation.draughting.faces import FaceCounts, count_faces
from linecad.evaluation.draughting.ground import GroundCounts, count_ground
from linecad.evaluation.draughting.lines import LineCounts, count_lines
from linecad.evaluation.draughting.shapes import NO_FACE, nearest_faces, shapes_of
from linecad.evaluation.drawing_truth import Shown, TrueCounts, compare_faces
from linecad.evaluation.openings import windows_f1
from linecad.evaluation.references import Reference, pixel_grid
from linecad.scene import Scene

COLUMNS = 192  # of the grid of pixels that covered shares are counted on
DETAIL = "detail"  # the role of lines that are drawn on a layer of their own
OPENINGS = ("window", "door", "reveal")  # kinds of faces


@dataclass(frozen=True)
class DrawingScore:
    """A scene as a drawing."""

    photo_covered: float  # share of the photo that shows a face
    known_covered: float | None  # share of what is neither sky nor clutter that does; None where that is not known
    ground: GroundCounts
    faces: FaceCounts
    lines: LineCounts
    truth: TrueCounts | None  # made photos alone
    windows: float | None  # F1 at overlap 0.5 in component 0; None where the truth does not know windows
    all_windows: float | None  # of the whole scene


def score_drawing(scene: Scene, reference: Reference, scale: float | None) -> DrawingScore:
    """Count what a draughtsman would object to; `scale` is found over true depth, None where it is not known.

    What is neither sky nor clutter is known of made photos, and at the points of a survey elsewhere.
    """
    shapes = shapes_of(scene)
    pixels = pixel_grid(scene.camera.width, scene.camera.height, COLUMNS)
    face, depth = nearest_faces(scene, pixels, scene.faces)
    seen = np.bincount(face[face != NO_FACE], minlength=len(shapes))
    truth, covered = None, None
    if reference.truth is not None:
        truth = compare_faces(scene, shapes, Shown(pixels, face, depth), reference.truth, scale)
        covered = truth.covered / truth.pixels if truth.pixels else None
    elif reference.dense is not None and len(reference.dense.pixels):
        covered = float(np.isfinite(face_depths(scene, reference.dense.pixels, scene.faces)).mean())
    return DrawingScore(
        photo_covered=float((face != NO_FACE).mean()),
        known_covered=covered,
        ground=count_ground(scene, shapes, seen),
        faces=count_faces(scene, shapes, np.array([shape.face.kind in OPENINGS for shape in shapes], bool)),
        lines=count_lines(scene, shapes, _details(scene)),
        truth=truth,
        windows=None if reference.truth is None else windows_f1(scene, reference.truth),
        all_windows=None if reference.truth is None else windows_f1(scene, reference.truth, everywhere=True),
    )


def _details(scene: Scene) -> Bool:
    """Which lines (N,) are on the layer of details."""
    details: Bool = np.asarray(scene.lines.role) == DETAIL
    return details
