import json

import ezdxf
import pytest

from check_dxf import check
from expectation import build_expectation
from faults import missing_face, missing_hole, missing_line, moved_line
from verdict import judge


def verdict(path, expected):
    return judge(lambda findings: check(findings, str(path), expected))[-1]


@pytest.fixture
def changed(export_to):
    """Write a DXF that somebody changed; returns the file."""

    def write(change):
        path = export_to(".dxf")
        document = ezdxf.readfile(path)
        change(document)
        document.saveas(path)
        return path

    return write


def test_a_dxf_of_ours_is_right(export_to, expected):
    assert verdict(export_to(".dxf"), expected).startswith("CHECK OK ezdxf")


@pytest.mark.parametrize("by_band", [False, True])
def test_a_dxf_of_a_scene_with_probabilities_is_right(export_to, told, by_band):
    path = export_to(".dxf", told, by_band)
    assert verdict(path, json.loads(json.dumps(build_expectation(told, by_band)))).startswith("CHECK OK ezdxf")


def test_layers_by_probability_that_nobody_asked_for_are_noticed(export_to, told, expected):
    assert verdict(export_to(".dxf", told, by_band=True), expected).startswith("CHECK FAILED")


@pytest.mark.parametrize("fault", [moved_line, missing_line, missing_face, missing_hole])
def test_a_fault_is_noticed(export_to, expected, fault):
    fault(expected)
    assert verdict(export_to(".dxf"), expected).startswith("CHECK FAILED")


def move_line(document):
    line = document.modelspace().query("LINE").first
    line.dxf.start = line.dxf.start + ezdxf.math.Vec3(0, 0, 0.001)


def exchange_ids(document):
    first, second = document.modelspace().query('LINE[layer=="LINES_Z_BOUNDARY"]')[:2]
    one, two = (list(line.get_xdata("LINECAD")) for line in (first, second))
    first.set_xdata("LINECAD", two)
    second.set_xdata("LINECAD", one)


def drop_triangle(document):
    space = document.modelspace()
    space.delete_entity(space.query("3DFACE").first)


def show_inner_edges(document):
    for face in document.modelspace().query("3DFACE"):
        face.dxf.invisible_edges = 0


def drop_outline(document):
    space = document.modelspace()
    space.delete_entity(space.query("POLYLINE").first)


def millimetres(document):
    document.header["$INSUNITS"] = 4


def turn_green(document):
    document.layers.get("LINES_X_BOUNDARY").dxf.color = 3


def forget_camera(document):
    document.header.custom_vars.clear()


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (move_line, "the nearest of"),
        (exchange_ids, "is another one"),
        (drop_triangle, "do not bound the triangles"),
        (show_inner_edges, "shown or hidden wrongly"),
        (drop_outline, "outlines are not"),
        (millimetres, "INSUNITS"),
        (turn_green, "expected a red"),
        (forget_camera, "the properties tell"),
    ],
)
def test_a_change_is_noticed(changed, expected, change, told):
    found = verdict(changed(change), expected)
    assert found.startswith("CHECK FAILED")
    assert told in found


def test_half_a_file_is_no_file(export_to, expected):
    path = export_to(".dxf")
    path.write_text(path.read_text()[: path.stat().st_size // 2])
    assert verdict(path, expected).startswith("CHECK FAILED: 1 problem; first: DXF")


@pytest.mark.parametrize("by_role", [False, True])
def test_an_export_tells_roles_and_is_by_role_only_where_asked(export_to, drawn, by_role):
    told, other = (json.loads(json.dumps(build_expectation(drawn, by_role=asked))) for asked in (by_role, not by_role))
    path = export_to(".dxf", drawn, by_role=by_role)
    assert verdict(path, told).startswith("CHECK OK ezdxf")
    assert verdict(path, other).startswith("CHECK FAILED")


def test_roles_and_kinds_that_are_others_are_noticed(export_to, drawn, expected):
    assert verdict(export_to(".dxf", drawn), expected).startswith("CHECK FAILED")
    expected["faces"][0]["label"] = "wall 1"
    assert verdict(export_to(".dxf"), expected).startswith("CHECK FAILED")
