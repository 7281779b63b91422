"""The readers over what fuzzing kept, and over hostile values in every place of a good file."""

import contextlib
import copy
import json
import time
import warnings
from pathlib import Path

import pytest
from targets import CORPUS, TARGETS, folder_in_memory

from linecad.errors import CameraError, SceneFileError
from linecad.io.scene_file import read_scene, scene_from_json
from linecad.io.strict_json import MOST_VALUES, JsonError, parse

HOSTILE = [
    float("nan"), float("inf"), float("-inf"), 1e308, -1e308, 5e-324, 1e12, 1.0000001e12, 0, -1, 1.5, 2**31, 2**63,
    10**400, True, None, "", "x", "\ud800", "../../x", [], [[]], [None] * 3, {}, {"id": {}},
]  # fmt: skip
JSON_TARGETS = sorted(name for name, target in TARGETS.items() if target.is_json)
LONGEST = 20.0  # s, for a million entries on a slow machine; what is quadratic takes minutes for a tenth of them


@pytest.fixture
def folder():
    with folder_in_memory() as name:
        yield Path(name)


@pytest.mark.parametrize("name", sorted(TARGETS))
def test_what_fuzzing_kept(name, folder):
    kept = sorted((CORPUS / name).iterdir())
    assert len(kept) > 5
    for path in kept:
        TARGETS[name].read(path.read_bytes(), folder)


@pytest.mark.parametrize("name", sorted(TARGETS))
def test_the_seeds_are_good_files(name, folder):
    for seed in TARGETS[name].seeds():
        TARGETS[name].read(seed, folder)


def places(value, way=()):
    """The way to every value in nested lists and objects."""
    yield way
    members = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, member in members:
        yield from places(member, (*way, key))


def replaced(document, way, value):
    """A copy of the document with another value at one place."""
    if not way:
        return value
    changed = copy.deepcopy(document)
    at = changed
    for key in way[:-1]:
        at = at[key]
    at[way[-1]] = value
    return changed


@pytest.mark.parametrize("name", JSON_TARGETS)
def test_hostile_values_in_every_place(name, folder, thorough):
    """Every value in the thorough run, else every fifth, not the same in two places that follow each other."""
    share = 1 if thorough else 5
    document = json.loads(next(TARGETS[name].seeds()))
    for number, way in enumerate(places(document)):
        for value in HOSTILE[number % share :: share]:
            TARGETS[name].read(json.dumps(replaced(document, way, value)).encode(), folder)


@pytest.mark.parametrize("name", JSON_TARGETS)
def test_every_member_doubled_or_left_out(name, folder):
    document = json.loads(next(TARGETS[name].seeds()))
    for way in places(document):
        if not way:
            continue
        at = document
        for key in way[:-1]:
            at = at[key]
        if isinstance(at, list):
            without, twice = at[: way[-1]] + at[way[-1] + 1 :], [*at, at[way[-1]]]
            texts = [json.dumps(replaced(document, way[:-1], each)) for each in (without, twice)]
        else:
            without = {key: member for key, member in at.items() if key != way[-1]}
            marked = json.dumps(replaced(document, way[:-1], {**at, "MARK": at[way[-1]]}))
            texts = [
                json.dumps(replaced(document, way[:-1], without)),
                marked.replace('"MARK"', json.dumps(way[-1])),  # the key stands twice
            ]
        for text in texts:
            TARGETS[name].read(text.encode(), folder)


MANY = {
    "notes": lambda scene, count: json.dumps({**scene, "notes": ["x"] * count}),
    "empty lines": lambda scene, count: json.dumps({**scene, "lines": [{}] * count}),
    "lines with one id": lambda scene, count: json.dumps({**scene, "lines": scene["lines"][:1] * count}),
    "keys, two of them alike": lambda _, count: "{" + ", ".join(f'"{key}": 0' for key in [*range(count), 7]) + "}",
    "lists in lists": lambda _, count: "[" * count + "]" * count,
    "objects in objects": lambda _, count: '{"a":' * count + "0" + "}" * count,
    "points of a face": lambda scene, count: json.dumps(
        replaced(scene, ("planes", 0, "faces", 0, "outline"), [[0, 5, 0]] * (count // 4))
    ),
    "digits": lambda _, count: "1" * count,
    "distortion": lambda scene, count: json.dumps(replaced(scene, ("camera", "distortion"), [0.5] * count)),
}


@pytest.fixture(scope="module")
def many(thorough):
    """How many entries: a million, or as many as tell what is quadratic from what is not."""
    return 10**6 if thorough else 10**5


@pytest.mark.parametrize("name", MANY)
def test_a_million_entries_are_read_or_refused_in_seconds(name, many):
    text = MANY[name](json.loads(next(TARGETS["scene"].seeds())), many)
    began = time.process_time()
    with contextlib.suppress(SceneFileError):
        scene_from_json(text)
    assert time.process_time() - began < LONGEST


@pytest.mark.parametrize("name", ["keys, two of them alike", "lists in lists", "distortion"])
def test_a_camera_file_of_a_million_entries(name, tmp_path, many):
    from linecad.camera.intrinsics import read_calibration

    path = tmp_path / "camera.json"
    path.write_text(MANY[name](json.loads(next(TARGETS["scene"].seeds())), many))
    began = time.process_time()
    with pytest.raises(CameraError):
        read_calibration(path)
    assert time.process_time() - began < LONGEST


def test_more_values_than_fit_into_memory_are_refused_before_they_are_read():
    began = time.process_time()
    with pytest.raises(JsonError, match="holds more than"):
        parse("[" + "[]," * (MOST_VALUES // 2 + 1) + "[]]")
    assert time.process_time() - began < 1


def test_a_scene_file_larger_than_any_is_not_read(tmp_path):
    path = tmp_path / "scene.json"
    with path.open("wb") as file:
        file.truncate(10**10)  # a hole, which takes no room on the disk
    with pytest.raises(SceneFileError, match="larger than 256 MiB"):
        read_scene(path)


def test_overflows_would_be_found():
    """The tests above stand on this: a warning of NumPy is an error here."""
    import numpy as np

    with pytest.raises(RuntimeWarning), warnings.catch_warnings():
        np.float64(1e308) * np.float64(1e308)
