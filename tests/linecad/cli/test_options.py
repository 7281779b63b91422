"""Options as KEY=VALUE: listed by one command, read by all, refused before the work."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from exporters.formats import FORMATS
from linecad.cli.main import main
from linecad.options import SWITCHES

ROOT = Path(__file__).resolve().parents[3]
BAD = [
    ("seed=1.5", "option seed is '1.5', expected a whole number from 0 to 2147483647"),
    ("seed=2147483648", "expected a whole number from 0 to 2147483647"),
    ("without=nonsense", "option without is 'nonsense', expected one or more of cycles, planarity, boundary"),
    ("weights=heavy", "option weights is 'heavy', expected odds, junctions or ones"),
    ("formulation=other", "option formulation is 'other', expected bodies, gain or paper"),
    ("mu-boundary=1e300", "option mu-boundary is '1e300', expected a number from 0 to 1000000"),
    ("extension=1e9", "option extension is '1e9', expected px from 1 to 500"),
    ("joins=3", "option joins is '3', expected stable, biconnected or all"),
    ("depth-kind=deep", "option depth-kind is 'deep', expected z, distance, inverse or affine-inverse"),
    ("depth-view=-1", "option depth-view is '-1', expected a whole number from 0 to 999999"),
    ("depth-factor=0", "option depth-factor is '0', expected a number above 0, at most 1000000"),
    ("depth-array=", "option depth-array is '', expected a name"),
    ("depth-undistorted=yes", "option depth-undistorted is 'yes', expected on or off"),
    ("depth-kind=z", "option depth-kind tells of a depth map, and none is given"),
    ("nothing=1", "`linecad options` lists them all"),
    ("extension", "KEY=VALUE"),
]


@pytest.mark.parametrize(
    "command",
    [
        ["convert", "none.jpg", "-o", "a.json"], ["batch", "none.jpg", "-o", "out"], ["edit", "none.jpg"],
        ["evaluate", "none"],
    ],
    ids=lambda command: command[0],
)  # fmt: skip
@pytest.mark.parametrize(("text", "words"), BAD, ids=[text for text, _ in BAD])
def test_a_bad_option_is_refused_before_the_photo_is_looked_for(fails, command, text, words):
    assert words in fails(*command, "--option", text)


@pytest.mark.parametrize(
    "command",
    [
        ["convert", "none.jpg", "-o", "a.json", "--depth", "none.npz"], ["edit", "none.jpg", "--depth", "none.npz"],
        ["batch", "none.jpg", "-o", "out", "--depth-maps"], ["evaluate", "none", "--depth-maps"],
    ],
    ids=lambda command: command[0],
)  # fmt: skip
@pytest.mark.parametrize("other", [["--fast"], ["--option", "formulation=gain"], ["--option", "formulation=paper"]])
def test_a_map_for_a_program_that_looks_at_none_is_refused_before_the_photo_is_looked_for(fails, command, other):
    assert "only formulation=bodies looks at a depth map" in fails(*command, *other)


def test_the_paper_has_no_fast_answer(fails):
    said = fails("convert", "none.jpg", "-o", "a.json", "--fast", "--option", "formulation=paper")
    assert "a fast answer has no formulation 'paper'" in said


def test_the_page_has_no_options_of_formats(fails):
    assert "'tubes=on' is no option" in fails("edit", "none.jpg", "--option", "tubes=on")


def test_all_options_are_listed(capsys):
    assert main(["options"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert max(map(len, out.splitlines())) <= 80
    text = " ".join(out.split())
    listed = re.findall(r"^  (\S+) ", out, re.MULTILINE)
    of_formats = dict.fromkeys(option for row in FORMATS.values() for option in row.options)
    assert listed == [*(switch.key for switch in SWITCHES), *(option.key for option in of_formats)]
    for switch in (*SWITCHES, *of_formats):
        assert f"{switch.accepted} (default: {switch.usual})" in text
    assert "tubes .glb: lines as thin tubes" in text


def test_a_reader_that_has_seen_enough_ends_the_list_in_silence():
    command = [sys.executable, "-m", "linecad", "options"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        running.stdout.close()
        assert running.stderr.read() == b""
    assert running.returncode == 1
