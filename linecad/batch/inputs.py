"""The photos of a batch: what the command names, and the names of the files that are made of them."""

import hashlib
import os
import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from linecad.errors import PhotoError

# In a folder, files with these suffixes are taken for photos; named one by one, any file is.
PHOTO_SUFFIXES = frozenset(
    (".jpg", ".jpeg", ".jpe", ".png", ".tif", ".tiff", ".webp", ".bmp", ".gif", ".jp2", ".ppm", ".pgm", ".hdr", ".pfm")
)
LONGEST_NAME = 120  # bytes; systems take 255, and suffixes and hidden names need some of it
DIGEST = 8  # hexadecimal digits that tell photos of one name apart
_UNFIT = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|]')  # in names of files, on one system or another


def find_photos(given: Iterable[str], output: Path) -> list[Path]:
    """The photos that files, folders (with all that lies in them) and patterns name, each once, as absolute paths.

    The output folder is not searched. Raises PhotoError where a name or a pattern finds nothing.
    """
    found: dict[Path, None] = {}
    for name in given:
        path = Path(name)
        if path.is_dir():
            photos = sorted(_within(path, output.resolve()))
            if not photos:
                raise PhotoError(f"{path} holds no photos; name a folder with JPEG, PNG, TIFF or WebP files")
        elif path.exists():
            photos = [path]
        else:  # only where no such file is there: names may hold brackets
            photos = _matches(path)
            if not photos:
                raise PhotoError(f"{path} is no file or folder, nor a pattern that finds any; check the name")
        # Links stay what they are called, for folders of links to stores of files are common.
        found.update((photo.parent.resolve() / photo.name, None) for photo in photos)
    same: dict[str, Path] = {}
    for photo in found:
        same.setdefault(os.path.realpath(photo), photo)  # a link and what it points to are one photo
    return list(same.values())


def _matches(pattern: Path) -> list[Path]:
    """The files that a pattern names, hidden ones only where it says so."""
    start = Path(pattern.anchor or ".")
    try:
        found = sorted(start.glob(str(pattern.relative_to(pattern.anchor))))
    except (ValueError, NotImplementedError) as error:
        raise PhotoError(f"{pattern} is no pattern: {error}; check the name") from error
    wants_hidden = pattern.name.startswith(".")
    return [path for path in found if not path.is_dir() and (wants_hidden or not path.name.startswith("."))]


def _within(folder: Path, excluded: Path) -> Iterable[Path]:
    for place, folders, files in os.walk(folder):
        here = Path(place)
        if here.resolve() == excluded:
            folders.clear()
            continue
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in files:
            if not name.startswith(".") and Path(name).suffix.lower() in PHOTO_SUFFIXES:
                yield here / name


def output_names(photos: Iterable[Path], taken: dict[str, str]) -> dict[Path, str]:
    """A name, without suffix, for the files of each photo: its own, made fit for every system, and unlike all others.

    `taken` has the names that a record gives to photos, by the text of their paths: they stay as they are. The others
    that would share a name get eight digits of a hash of their path, so that it does not matter which came first.
    """
    photos = list(photos)
    kept = {photo: taken[str(photo)] for photo in photos if str(photo) in taken}
    used = {name.casefold() for name in taken.values()}
    plain = {photo: _fit(photo) for photo in photos if photo not in kept}
    counts = Counter(name.casefold() for name in plain.values())
    names = dict(kept)
    for photo, name in plain.items():
        if counts[name.casefold()] > 1 or name.casefold() in used:
            digest = hashlib.sha256(os.fsencode(photo)).hexdigest()[:DIGEST]
            name = f"{name}-{digest}"
        names[photo] = name
    return names


def _fit(photo: Path) -> str:
    """The photo's name without suffix as a plain name of a file that is neither hidden nor a place."""
    name = _UNFIT.sub("_", os.fsencode(photo.stem).decode(errors="replace")).lstrip(".").rstrip(". ")
    short = name.encode()[:LONGEST_NAME].decode(errors="ignore")
    return short or "photo"
