"""Which depth map belongs to a photo, by its name beside it: the names that people, and networks, give to them."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from linecad.errors import DepthMapError

SUFFIXES = (".npz", ".npy", ".exr", ".pfm", ".png", ".tif", ".tiff")
# In this order, the first that is there: what was named for this purpose, what Depth Anything 2 names so, MoGe's folder
# of a photo, and last what may be anything, as Depth Pro names it.
NAMED = tuple(f"{{stem}}{mark}{suffix}" for mark in (".depth", "_depth") for suffix in SUFFIXES)
NAMES = (*NAMED, "{stem}_raw_depth_meter.npy", "{stem}/depth.exr", "{stem}.npz")
FOLDER_MARK = "depth.exr"  # what tells that a folder is one that MoGe made of a photo


def find_maps(photos: Sequence[Path]) -> dict[Path, Path]:
    """The depth maps beside photos, by photo. Raises DepthMapError where none of them has one."""
    found = {photo: path for photo in photos if (path := find_map(photo)) is not None}
    if photos and not found:
        name = photos[0].with_name(NAMES[0].format(stem=photos[0].stem))
        raise DepthMapError(
            f"no photo has a depth map beside it; name them like {name} (docs/guide/depth-maps.md has all names)"
        )
    return found


def find_map(photo: Path) -> Path | None:
    """The depth map beside a photo; None where there is none."""
    return next((path for path in _maps(photo) if path.is_file()), None)


def photos_alone(photos: Iterable[Path]) -> list[Path]:
    """Those of some pictures that are no depth map of another one, and that do not lie in the folder of one's map."""
    photos = list(photos)
    maps = {path for photo in photos for path in _maps(photo)}
    folders = {photo.with_name(photo.stem) for photo in photos}
    made = {folder for folder in folders if (folder / FOLDER_MARK).is_file()}
    return [photo for photo in photos if photo not in maps and photo.parent not in made]


def _maps(photo: Path) -> Iterator[Path]:
    """Where the map of a photo may lie, the best first."""
    for name in NAMES:
        yield photo.parent / name.format(stem=photo.stem)
