import pytest

from faults import missing_line, missing_wall, moved_line
from verdict import judge

ifcopenshell = pytest.importorskip("ifcopenshell", reason="the extra `ifc` is not installed")
check_ifc = pytest.importorskip("check_ifc", reason="the extra `ifc` is not installed")

# The rules of the schema take 8 s a file; where a fault is none of the schema, the validator is left out.


def verdict(path, expected):
    return judge(lambda findings: check_ifc.check(findings, path, expected))[-1]


@pytest.fixture
def changed(export_to):
    """Write an IFC that somebody changed; returns the file."""

    def write(change):
        path = export_to(".ifc")
        file = ifcopenshell.open(str(path))
        change(file)
        file.write(str(path))
        return path

    return write


@pytest.fixture
def without_rules(monkeypatch):
    monkeypatch.setattr(check_ifc.ifcopenshell.validate, "validate", lambda *_, **__: None)


def test_an_ifc_of_ours_is_right(export_to, expected):
    assert verdict(export_to(".ifc"), expected).startswith("CHECK OK ifcopenshell")


@pytest.mark.usefixtures("without_rules")
@pytest.mark.parametrize("fault", [moved_line, missing_line, missing_wall])
def test_a_fault_is_noticed(export_to, expected, fault):
    fault(expected)
    assert verdict(export_to(".ifc"), expected).startswith("CHECK FAILED")


def fill_an_opening(file):
    """Take an opening out, so that its wall is whole."""
    file.remove(file.by_type("IfcRelVoidsElement")[0])


def lose_a_window(file):
    file.remove(file.by_type("IfcWindow")[0])


def thin_a_wall(file):
    file.by_type("IfcWall")[0].Representation.Representations[0].Items[0].Depth = 0.2


@pytest.mark.usefixtures("without_rules")
@pytest.mark.parametrize("change", [fill_an_opening, lose_a_window, thin_a_wall])
def test_a_change_of_the_file_is_noticed(changed, expected, change):
    assert verdict(changed(change), expected).startswith("CHECK FAILED")


@pytest.mark.thorough
def test_what_breaks_a_rule_of_the_schema_is_noticed(changed, expected):
    def turn(file):
        file.by_type("IfcExtrudedAreaSolid")[-1].ExtrudedDirection.DirectionRatios = (1.0, 0.0, 0.0)

    assert "the validator says" in verdict(changed(turn), expected)
