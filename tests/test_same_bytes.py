"""The same photo gives the same bytes, in every format and every process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from exporters.formats import FORMATS

ROOT = Path(__file__).resolve().parents[1]
SAMPLES = ROOT / "samples"
PARTED = ["components=on", "probability=on", "roles=on"]


def converted(photo, folder, seed, options):
    """The bytes of all files that a conversion makes, by name; `seed` orders the sets of the process."""
    folder.mkdir()
    outputs = [word for suffix in (".json", *FORMATS) for word in ("-o", f"{photo.stem}{suffix}")]
    given = [word for option in options for word in ("--option", option)]
    command = [sys.executable, "-m", "linecad", "convert", str(photo), *outputs, *given, "--quiet"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": str(seed)}
    subprocess.run(command, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL)
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.thorough
@pytest.mark.parametrize("options", [[], PARTED], ids=["plain", "parted"])
@pytest.mark.parametrize("photo", sorted(SAMPLES.glob("*.jpg")), ids=lambda path: path.stem)
def test_two_runs_give_the_same_bytes_in_every_format(photo, options, tmp_path):
    first, second = (converted(photo, tmp_path / name, seed, options) for seed, name in enumerate("ab", 1))
    assert {suffix for suffix in (".json", *FORMATS) if f"{photo.stem}{suffix}" not in first} == set()
    assert list(filter(lambda name: first[name] != second.get(name), first)) == []
    assert first.keys() == second.keys()
