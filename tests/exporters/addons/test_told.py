"""What add-ons read of a scene file agrees with what linecad itself makes of it."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from exporters import bands
from exporters.addons import told as told_of
from exporters.addons.running import AddonError, Request
from exporters.addons.told import GROUPINGS, groups_of, is_shown, read_scene_file, write_photo
from exporters.formats import export
from exporters.model import build_model
from linecad.confidence import keep_probable
from linecad.errors import ConfidenceError
from linecad.io.scene_file import write_scene
from linecad.scene import ROLES


@pytest.fixture
def read(tmp_path):
    def written(scene):
        path = tmp_path / "scene.json"
        write_scene(scene, path)
        return read_scene_file(path)

    return written


def with_roles(scene):
    roles = np.resize(ROLES, len(scene.lines))
    return replace(scene, lines=replace(scene.lines, role=roles, component=np.zeros(len(scene.lines), np.int64)))


def test_words_are_those_of_the_formats():
    assert dict(told_of.BANDS) == bands.LEAST
    assert list(told_of.ROLES) == list(ROLES)


def test_parts_are_the_groups_of_exports(told, read):
    scene = with_roles(told)
    groups = {group.name: sorted(group.ids.tolist()) for group in build_model(scene, True, True).groups}
    parts: dict[str, list[int]] = {}
    for number, line in read(scene).lines.items():
        parts.setdefault(line.part, []).append(number)
    assert {name: sorted(ids) for name, ids in parts.items()} == groups
    assert {line.base for line in read(scene).lines.values()} == {group.name for group in build_model(scene).groups}


def test_lines_of_other_components_are_parts_of_their_own(told, read):
    (alone,) = told.lines.id[told.lines.component == 1].tolist()
    assert read(told).lines[alone].part.endswith(" component 1")


def test_lines_of_further_frames_have_their_axes(scene, read):
    turned = replace(scene, turns=(0.3,), lines=replace(scene.lines, axis=np.resize([3, 4, 2], len(scene.lines))))
    assert {line.axis for line in read(turned).lines.values()} == {"x2", "y2", "z"}


def test_ends_are_in_metres_and_as_exports_order_them(scene, read):
    half = replace(scene, metres_per_unit=0.5)
    lines = read(half).lines
    for group in build_model(half).groups:
        assert group.ids.tolist() == sorted(number for number, line in lines.items() if line.base == group.name)
        np.testing.assert_allclose([lines[number].ends for number in group.ids.tolist()], group.ends)


@given(least=st.floats(0, 1), seed=st.integers(0, 99))
def test_what_is_shown_is_what_confidence_keeps(row, tmp_path_factory, least, seed):
    """Walls with lines of any probability, openings with theirs, and planes without lines."""
    rng = np.random.default_rng(seed)
    ids = row.lines.id.tolist()
    planes = [replace(plane, lines=tuple(rng.choice(ids, rng.integers(0, 3), False).tolist())) for plane in row.planes]
    lines = replace(row.lines, probability=rng.random(len(ids)))
    scene = replace(row, lines=lines, planes=tuple(planes))
    path = tmp_path_factory.mktemp("scene") / "scene.json"
    write_scene(scene, path)
    told = read_scene_file(path)
    try:
        kept = keep_probable(scene, least)
    except ConfidenceError:
        return  # no line is left, which the command refuses
    shown = [number for number, line in told.lines.items() if is_shown(line.probability, least)]
    assert shown == kept.lines.id.tolist()
    faces = {number for number, face in told.faces.items() if is_shown(face.probability, least)}
    assert faces == {face.id for _, face in kept.faces}


def test_where_nothing_is_told_everything_is_shown(scene, read):
    told = read(scene)
    assert all(is_shown(each.probability, 1.0) for each in (*told.lines.values(), *told.faces.values()))
    assert {line.band for line in told.lines.values()} == {"not told"}


def test_every_grouping_has_every_part_once_and_in_order(told, read):
    scene = with_roles(told)
    scene = replace(scene, lines=replace(scene.lines, component=np.resize([0, 2, 10], len(scene.lines))))
    parts = {line.part: line.groups() for line in read(scene).lines.values()}
    found = {by: groups_of(parts, by) for by, _, _ in GROUPINGS}
    for groups in found.values():
        assert Counter(name for names in groups.values() for name in names) == Counter(list(parts))
    assert list(found["axis"]) == ["lines x", "lines y", "lines z"]
    assert list(found["role"]) == ["outlines", "openings", "details"]
    assert list(found["confidence"]) == ["sure", "likely", "guess"]
    assert list(found["component"]) == ["component 0", "component 2", "component 10"]


def test_the_photo_of_a_project_is_its_jpeg(scene, photo, tmp_path):
    request = Request(tmp_path / "a.jpg")
    request.folder.mkdir()
    project = request.output(".fspy")
    export(scene, project, photo)
    with Image.open(write_photo(request)) as picture:
        assert (picture.format, picture.size) == ("JPEG", (scene.camera.width, scene.camera.height))
        difference = np.abs(np.asarray(picture, float) - photo)
    assert np.median(difference) <= 2  # of 255
    project.write_bytes(project.read_bytes()[:-1])
    with pytest.raises(AddonError, match="newer than this add-on"):
        write_photo(request)
    project.unlink()
    with pytest.raises(AddonError, match=r"a\.fspy: No such file or directory; the photo cannot be shown"):
        write_photo(request)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"lines": [{"id": 1}]}'])
def test_what_is_no_scene_file_is_refused(tmp_path, text):
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(AddonError, match="could not be read as a scene file"):
        read_scene_file(path)
