"""A model from where the camera was not, to look at: python tests/benchmarks/turned.py SCENE.json|PHOTO ... -o DIR

Writes each scene as GLB by the exporter, with the photo on its faces, reads that file, and draws what is in it, all of
it and nothing else: as the photo's camera sees it, 30 degrees from the left and from the right, from above, and
straight before the facade that fills most of the photo; one picture a photo, DIR/NAME.png, with the photo beside them.
The photo of a scene file lies beside it or in a folder of --photos (there also as NAME/photo.jpg for a scene file
...NAME.json, as in a made dataset); a JSON beside the photo with its camera matrix is its calibration. --keep leaves
the GLB beside the picture. Prints a line a photo with the seconds for writing and for drawing.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from linecad.camera.distortion import open_photo
from linecad.camera.photo import Photo
from linecad.camera.reread import reread_photo
from linecad.errors import LinecadError, PhotoError
from linecad.evaluation.turned.glb import read_glb
from linecad.evaluation.turned.panels import draw_panels
from linecad.io.scene_file import read_scene
from linecad.options import Options
from linecad.outputs import write_outputs
from linecad.pipeline import reconstruct
from linecad.scene import Scene


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("inputs", type=Path, nargs="+", metavar="SCENE.json|PHOTO")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--photos", type=Path, nargs="+", default=[], metavar="DIR", help="where the photos lie")
    parser.add_argument("--no-lines", action="store_true", help="faces alone")
    parser.add_argument("--keep", action="store_true", help="leave the GLB beside each picture")
    parser.add_argument("--plain", action="store_true", help="without the photo, where that may not be shown")
    parser.add_argument("--jpeg", action="store_true", help="JPEG, a fifth of the size")
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    for path in chosen.inputs:
        try:
            scene, photo = scene_of(path, chosen.photos) if path.suffix == ".json" else made_of(path)
        except LinecadError as error:
            print(f"{path.stem}: {error}", flush=True)
            continue
        with tempfile.TemporaryDirectory() as folder:
            glb = (chosen.out if chosen.keep else Path(folder)) / f"{path.stem}.glb"
            began = time.perf_counter()
            write_outputs(scene, None if chosen.plain else photo.pixels, [glb], {})
            written = time.perf_counter()
            picture = draw_panels(read_glb(glb), None if chosen.plain else photo.pixels, path.stem, not chosen.no_lines)
            drawn = time.perf_counter()
        picture.save(chosen.out / f"{path.stem}.{'jpg' if chosen.jpeg else 'png'}")
        print(f"{path.stem}: {written - began:.2f} s to write, {drawn - written:.2f} s to draw", flush=True)


def made_of(path: Path) -> tuple[Scene, Photo]:
    """A photo, and its scene at the default settings."""
    photo = open_photo(path, calibration_of(path))
    return reconstruct(photo, Options()), photo


def scene_of(path: Path, folders: Iterable[Path]) -> tuple[Scene, Photo]:
    """The scene in a file, and its photo."""
    scene = read_scene(path)
    name = Path(scene.photo).name
    places = [path.with_name(name)]
    for folder in folders:
        places += [
            folder / name,
            *(inner / name for inner in sorted(folder.iterdir()) if path.stem.endswith(inner.name)),
        ]
    photo = next((place for place in places if place.is_file()), None)
    if photo is None:
        raise PhotoError(f"{name} lies in none of the folders; name its folder with --photos")
    given = scene.camera.source == "file"
    return scene, reread_photo(photo, name, scene.camera, calibration_of(photo) if given else None)


def calibration_of(photo: Path) -> Path | None:
    """The JSON with a camera matrix that belongs to a photo."""
    for path in (photo.with_suffix(".json"), photo.with_name("camera.json")):
        if path.is_file() and "K" in json.loads(path.read_text(encoding="utf-8")):
            return path
    return None


if __name__ == "__main__":
    main()
