import pytest

from faults import missing_face, missing_hole, missing_line, moved_line
from verdict import judge

rhino3dm = pytest.importorskip("rhino3dm", reason="the extra `rhino` is not installed")
check = pytest.importorskip("check_rhino", reason="the extra `rhino` is not installed").check


def verdict(path, expected):
    return judge(lambda findings: check(findings, path, expected))[-1]


@pytest.fixture
def changed(export_to):
    """Write a 3DM that somebody changed; returns the file."""

    def write(change):
        path = export_to(".3dm")
        file = rhino3dm.File3dm.Read(str(path))
        change(file)
        file.Write(str(path), 6)
        return path

    return write


def test_a_3dm_of_ours_is_right(export_to, expected):
    assert verdict(export_to(".3dm"), expected).startswith("CHECK OK rhino3dm")


@pytest.mark.parametrize("fault", [moved_line, missing_line, missing_face, missing_hole])
def test_a_fault_is_noticed(export_to, expected, fault):
    fault(expected)
    assert verdict(export_to(".3dm"), expected).startswith("CHECK FAILED")


def first(file, kind):
    return next(item for item in file.Objects if item.Geometry.ObjectType == kind)


def lose_a_surface(file):
    file.Objects.Delete(str(first(file, rhino3dm.ObjectType.Brep).Attributes.Id))


def move_a_surface(file):
    first(file, rhino3dm.ObjectType.Brep).Geometry.Translate(rhino3dm.Vector3d(0, 0, 0.001))


def turn_a_surface(file):
    first(file, rhino3dm.ObjectType.Brep).Geometry.Flip()


def count_in_feet(file):
    file.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Feet


@pytest.mark.parametrize("change", [lose_a_surface, move_a_surface, turn_a_surface, count_in_feet])
def test_a_change_of_the_file_is_noticed(changed, expected, change):
    assert verdict(changed(change), expected).startswith("CHECK FAILED")
