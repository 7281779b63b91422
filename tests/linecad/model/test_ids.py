"""Ids of lines are places in the photo: what lies elsewhere does not change them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.arrays import rows_of
from linecad.cli.main import main
from linecad.io.scene_file import read_scene
from linecad.model.ids import CELLS, PLACES, ids_by_place, with_ids_by_place
from linecad.scene import Camera, Intersections, Lines, Plane, Scene, SolveReport

SAMPLES = Path(__file__).resolve().parents[3] / "samples"
CAMERA = Camera(1000, 700, np.array([[900.0, 0, 500], [0, 900, 350], [0, 0, 1]]), "file")


def lines_at(middles, axis=0, pieces=()):
    middles = np.asarray(middles, float).reshape(-1, 1, 2)
    count = len(middles)
    return Lines(
        id=np.arange(count), axis=np.full(count, axis), segment=middles + np.array([[-4, 0], [4, 0]]),
        ends=np.zeros((count, 2, 3)),
        is_boundary=np.zeros(count, bool), component=np.zeros(count, int), confidence=np.full(count, "supported"),
        pieces=pieces,
    )  # fmt: skip


def test_an_id_tells_the_place():
    assert ids_by_place(lines_at([[235, 452]]), CAMERA).tolist() == [45230]
    assert ids_by_place(lines_at([[-0.4, -0.4], [999.4, 699.4]]), CAMERA).tolist() == [0, 69990]


def test_neighbours_are_told_apart_by_axis_then_place():
    lines = lines_at([[238, 452], [232, 452], [235, 457]])
    assert ids_by_place(lines, CAMERA).tolist() == [45232, 45230, 45231]
    turned = replace(lines, axis=[0, 1, 1])
    assert ids_by_place(turned, CAMERA).tolist() == [45230, 45231, 45232]


def test_a_line_of_pieces_is_where_the_longest_is():
    pieces = (np.array([[[100, 100], [120, 100]], [[300, 100], [340, 100]], [[500, 100], [520, 100]]]),)
    assert ids_by_place(lines_at([[310, 100]], pieces=pieces), CAMERA).tolist() == [10320]


def test_no_lines_have_no_ids():
    assert ids_by_place(lines_at([]), CAMERA).tolist() == []


@given(st.lists(st.tuples(st.integers(0, 999), st.integers(0, 699)), unique=True, min_size=1, max_size=60), st.data())
def test_a_line_that_goes_changes_only_the_ids_beside_it(middles, data):
    """Ids were positions: one line less, and all behind it were others."""
    lines = lines_at(middles)
    ids = ids_by_place(lines, CAMERA)
    assert len(set(ids.tolist())) == len(ids)
    gone = data.draw(st.integers(0, len(middles) - 1))
    kept = np.arange(len(middles)) != gone
    left = ids_by_place(rows_of(lines, kept), CAMERA)
    if (ids < CELLS * CELLS * PLACES).all():
        elsewhere = ids[kept] // PLACES != ids[gone] // PLACES
        assert left[elsewhere].tolist() == ids[kept][elsewhere].tolist()


@given(st.permutations(range(12)))
def test_the_order_of_lines_does_not_count(order):
    lines = lines_at([[200 + 3 * (number % 4), 300 + 5 * (number // 4)] for number in range(12)])
    ids = ids_by_place(lines, CAMERA)
    assert ids_by_place(rows_of(lines, np.array(order)), CAMERA).tolist() == ids[order].tolist()


def test_a_crowd_finds_ids_behind_all_places():
    ids = ids_by_place(lines_at([[230 + number / 4, 452] for number in range(PLACES + 3)]), CAMERA).tolist()
    last = CELLS * CELLS * PLACES
    assert ids == [*range(45230, 45240), last, last + 1, last + 2]


@pytest.mark.thorough
def test_another_option_leaves_the_ids_of_the_lines_that_it_leaves(tmp_path):
    scenes = []
    for name, more in (("a", []), ("b", ["--option", "extension=60"])):
        arguments = [str(SAMPLES / "courtyard.jpg"), "--camera", str(SAMPLES / "courtyard.json"), *more]
        assert main(["convert", *arguments, "-o", str(tmp_path / f"{name}.json"), "--quiet"]) == 0
        scenes.append(read_scene(tmp_path / f"{name}.json"))
    found = [
        {(axis, ends.tobytes()): number for axis, ends, number in zip(
            lines.axis.tolist(), lines.segment, lines.id.tolist(), strict=True)}
        for lines in (scene.lines for scene in scenes)
    ]  # fmt: skip
    both = found[0].keys() & found[1].keys()
    assert len(both) > 500
    assert np.mean([found[0][look] == found[1][look] for look in both]) > 0.9


def test_all_that_names_a_line_has_the_new_id():
    lines = replace(lines_at([[600, 300], [100, 100], [400, 50]]), id=[4, 7, 2])
    crossings = Intersections(
        lines=[[4, 7], [2, 4]], kind=["L", "T"], pixel=np.zeros((2, 2)), real=[True, False], in_tree=[True, False],
        weight=[1, 1],
    )  # fmt: skip
    planes = (Plane(0, 1, 3.0, (7, 2)), Plane(1, 2, 1.0, ()))
    report = SolveReport("s", "bodies", "optimal", 1.0, 1.0, 0.0)
    scene = Scene("a.jpg", CAMERA, np.eye(3), lines, crossings, planes, report)
    numbered = with_ids_by_place(scene)
    known = {4: 30600, 7: 10100, 2: 5400}
    assert numbered.lines.id.tolist() == sorted(known.values())
    assert numbered.lines.segment.tolist() == lines.segment[[2, 1, 0]].tolist()
    assert numbered.intersections.lines.tolist() == [
        [known[line] for line in pair] for pair in scene.intersections.lines.tolist()
    ]
    assert [plane.lines for plane in numbered.planes] == [
        tuple(known[line] for line in plane.lines) for plane in scene.planes
    ]
    assert with_ids_by_place(numbered).lines.id.tolist() == numbered.lines.id.tolist()
