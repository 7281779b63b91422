"""FreeCAD itself is run by .ci/clients.sh; here a script stands in for it."""

from pathlib import Path

import pytest

from check_freecad import report_of


@pytest.fixture
def program(tmp_path):
    def write(text):
        path = tmp_path / "freecadcmd"
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
        return str(path)

    return write


def test_the_report_is_what_counts(program):
    speaking = program('echo Importing; echo "CHECK OK $CHECK_FILE $CHECK_GUI" > "$CHECK_REPORT"; exit 1')
    assert report_of(Path("a.step"), Path("b.json"), True, speaking) == [f"CHECK OK {Path('a.step').resolve()} 1"]


@pytest.mark.parametrize("status", [0, 3])
def test_without_a_verdict_it_has_failed_whatever_its_exit_status(program, status):
    dying = program(f"echo Segmentation fault; exit {status}")
    last = report_of(Path("a.step"), Path("b.json"), False, dying)[-1]
    assert last.startswith("CHECK FAILED")
    assert f"ended with {status} and gave no verdict" in last
    assert "Segmentation fault" in last


def test_libraries_for_its_python_come_behind_the_checkers(program, tmp_path):
    speaking = program('echo "CHECK OK $PYTHONPATH" > "$CHECK_REPORT"')
    (said,) = report_of(Path("a.ifc"), Path("b.json"), False, speaking, tmp_path)
    assert said == f"CHECK OK {Path(__file__).parent}:{tmp_path}"


def test_without_freecad_it_has_failed():
    last = report_of(Path("a.step"), Path("b.json"), False, "no-such-program")[-1]
    assert last.startswith("CHECK FAILED")
    assert "no-such-program" in last
