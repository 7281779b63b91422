"""What is right and wrong on photos of known depth, to look at: python tests/benchmarks/gallery.py DATASET... --out DIR

Pictures without the photo's own pixels, so that they may be shown where the photo may not. DATASET-NAME.png: on the
left the lines and faces that were found (unsure ones dashed and pale), on the right the points of known depth: right
within 5 %, wrong, or without a depth in component 0. DATASET-NAME.svg: the lines from above and from the side, beside
their true places, as `linecad evaluate --report` shows them. Prints a line a photo.
"""

import argparse
from pathlib import Path

import numpy as np

from exporters.colours import line_colour
from exporters.picture.canvas import Canvas
from exporters.picture.faces import draw_faces, draw_line, words_of
from linecad.arrays import Float
from linecad.errors import DatasetError, LinecadError
from linecad.evaluation.datasets import Case, find_dataset
from linecad.evaluation.depth import dense_depths, line_depths
from linecad.evaluation.gallery import draw_places
from linecad.evaluation.references import Points, open_case
from linecad.evaluation.scopes import score_scene
from linecad.options import Options
from linecad.pipeline import reconstruct
from linecad.scene import Scene
from solver.options import SolveOptions

WIDTH = 780  # px of each of the two panels
LINE_WIDTH = 2  # px
PAPER, INK = (1.0, 1.0, 1.0), (0.15, 0.15, 0.17)
RIGHT, WRONG, MISSING = (0.05, 0.55, 0.25), (0.85, 0.1, 0.1), (0.78, 0.78, 0.8)
EDGE_RADIUS, DENSE_RADIUS = 2.0, 1.2  # px of a point
SVG = "http://www.w3.org/2000/svg"  # a file needs the name, a page does not
MOST_POINTS = 6000
TITLE_HEIGHT, TITLE_SIZE = 34, 18  # px


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, required=True, help="folder of the pictures")
    parser.add_argument("--only", default="", help="photos with this in their name")
    parser.add_argument("--fast", action="store_true", help="the robust fit alone")
    parser.add_argument("--time-limit", type=float, default=20.0)
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    options = Options(solve=SolveOptions(time_limit_s=chosen.time_limit, fast=chosen.fast))
    for folder in chosen.dataset:
        for case in find_dataset(folder).cases:
            if chosen.only in case.name:
                try:
                    show(case, options, chosen.out / f"{folder.name}-{case.name}.png")
                except LinecadError as error:
                    print(f"{case.name}: {error}")


def show(case: Case, options: Options, path: Path) -> None:
    """Draw the pictures of one photo; DatasetError where no depth is known."""
    photo, reference = open_case(case)
    if reference.edges is None:
        raise DatasetError("no point of known depth")
    scene = reconstruct(photo, options)
    own = scene.lines.component == 0
    found = score_scene(scene, reference.edges, reference.dense).component_0
    # Without a scale no depth of component 0 can be compared: all points are then without a depth.
    scale = np.nan if found.lines.scale is None else found.lines.scale
    height = round(WIDTH * scene.camera.height / scene.camera.width)
    canvas = Canvas(2 * WIDTH, height + TITLE_HEIGHT, PAPER)
    draw_model(canvas.window(0, TITLE_HEIGHT, WIDTH, height), scene)
    panel = canvas.window(WIDTH, TITLE_HEIGHT, WIDTH, height)
    said = [case.name, f"{len(scene.lines)} lines, {own.sum()} in component 0"]
    if reference.dense is not None and found.dense is not None:
        said.append(f"dense: recall {found.dense.recall_5:.2f}, precision {found.dense.precision_5:.3f}")
        depth = dense_depths(scene, reference.dense.pixels, own) / scale
        draw_points(panel, scene, reference.dense, depth, DENSE_RADIUS)
    said.append(f"edges: recall {found.lines.recall_5:.2f}, precision {found.lines.precision_5:.3f}")
    draw_points(panel, scene, reference.edges, line_depths(scene, reference.edges.pixels, own) / scale, EDGE_RADIUS)
    panel.frame(MISSING)
    canvas.text(10, 24, "   ".join(said), TITLE_SIZE, INK)
    canvas.image().quantize(64).save(path, optimize=True)
    places = None if found.lines.scale is None else draw_places(scene, reference, found.lines.scale)
    if places is not None:
        path.with_suffix(".svg").write_text(places.replace("<svg", f'<svg xmlns="{SVG}"', 1), encoding="utf-8")
    print("   ".join(said), flush=True)


def draw_model(panel: Canvas, scene: Scene) -> None:
    """Faces and lines as found."""
    scale = np.array([panel.width / scene.camera.width, panel.height / scene.camera.height])
    draw_faces(panel, scene, scale)
    words = words_of(scene.lines)[0]
    shown = (scene.lines.segment + 0.5) * scale - 0.5
    for number in range(len(scene.lines)):
        colour = line_colour(int(scene.lines.axis[number]), bool(scene.lines.is_boundary[number]))
        draw_line(panel, shown[number].tolist(), words[number], colour, LINE_WIDTH)
    panel.frame(MISSING)


def draw_points(panel: Canvas, scene: Scene, points: Points, depth: Float, radius: float) -> None:
    """The points of known depth, by what the scene says of them."""
    scale = np.array([panel.width / scene.camera.width, panel.height / scene.camera.height])
    step = -(-len(depth) // MOST_POINTS)
    with np.errstate(invalid="ignore"):
        right = np.abs(depth / points.depth - 1) < 0.05
    for number in range(0, len(depth), step):
        colour = MISSING if not np.isfinite(depth[number]) else RIGHT if right[number] else WRONG
        panel.disc(((points.pixels[number] + 0.5) * scale - 0.5).tolist(), radius, colour)


if __name__ == "__main__":
    main()
