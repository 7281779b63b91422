import sys

import pytest

from check_same import check
from verdict import judge

WRITING = "import pathlib, sys, {modules}; pathlib.Path(sys.argv[1]).write_text({text})"


def verdict(program):
    command = [sys.executable, "-c", program, "{OUT}/a.txt"]
    return judge(lambda findings: check(findings, command, pause=0.0))[-1]


def test_the_same_bytes_are_right():
    assert verdict(WRITING.format(modules="os", text="'same'")).startswith("CHECK OK 1 files, the same in 3 runs")


def test_what_is_named_after_an_output_belongs_to_it():
    folder = "; t = pathlib.Path(sys.argv[1] + '.textures'); t.mkdir(); (t / '0.jpg').write_text('')"
    assert verdict(WRITING.format(modules="os", text="''") + folder).startswith("CHECK OK 2 files")


@pytest.mark.parametrize(
    ("modules", "text", "told"),
    [
        ("time", "str(time.time_ns())", "run 2 differs"),
        ("os", "str(hash('seed'))", "run 2 differs"),
        ("os", "sys.argv[1]", "run 2 differs"),
        ("tempfile", "tempfile.mkdtemp()[:0]", "among the temporary files"),
        ("pathlib", "str(pathlib.Path(sys.argv[1] + '~').write_text(''))", "is left over"),
        ("os", "missing", "ended with 1"),
    ],
)
def test_a_difference_and_what_is_left_over_are_noticed(modules, text, told):
    found = verdict(WRITING.format(modules=modules, text=text))
    assert found.startswith("CHECK FAILED")
    assert told in found


def test_an_output_that_is_not_written_is_noticed():
    assert "a.txt was not written" in verdict("pass")
