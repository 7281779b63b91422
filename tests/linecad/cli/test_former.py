"""Arguments of earlier versions end with exit code 2 and name the new spelling."""

import pytest

from linecad.cli.former import ALL, OBJECTIVE, SWITCHED, VALUED
from linecad.cli.main import main
from linecad.options import SWITCHES, Options, read_options

PHOTO_COMMANDS = {"convert": ["a.jpg", "-o", "a.json"], "batch": ["a.jpg", "-o", "out"], "edit": ["a.jpg"]}
NEW = [
    (["--extension", "60"], "--extension 60 is now --option extension=60"),
    (["--extension=60"], "--extension 60 is now --option extension=60"),
    (["--formulation", "paper"], "--formulation paper is now --option formulation=paper"),
    (["--backend", "highs"], "--backend highs is now --option backend=highs"),
    (["--without", "cycles,boundary"], "--without cycles,boundary is now --option without=cycles,boundary"),
    (["--mu-planarity", "0.5"], "--mu-planarity 0.5 is now --option mu-planarity=0.5"),
    (["--mu-boundary", "-1"], "--mu-boundary -1 is now --option mu-boundary=-1"),
    (["--gap", "0.01"], "--gap 0.01 is now --option gap=0.01"),
    (["--seed", "3"], "--seed 3 is now --option seed=3"),
    (["--seed"], "--seed VALUE is now --option seed=VALUE"),
    (["--seed", "three\nfour"], "--seed VALUE is now --option seed=VALUE"),
    (["--collinear"], "--collinear is now --option collinear=on"),
    (["--no-collinear"], "--no-collinear is now --option collinear=off"),
    (["--faint"], "--faint is now --option faint=on"),
    (["--largest-component"], "--largest-component is now --option largest-component=on"),
    (["--witnesses", "2"], "--witnesses is gone; use --option joins=stable, biconnected or all"),
    (["--weights", "junctions"], "--weights junctions is now --option weights=junctions"),
    (["--weights", "fitted"], "--weights fitted is gone, it measured no better than odds"),
]


@pytest.mark.parametrize("command", PHOTO_COMMANDS)
@pytest.mark.parametrize(("old", "new"), NEW, ids=[" ".join(old) for old, _ in NEW])
def test_an_old_spelling_names_the_new_one(fails, command, old, new):
    assert fails(command, *PHOTO_COMMANDS[command], *old, code=2) == f"linecad {command}: {new}"


@pytest.mark.parametrize("flag", OBJECTIVE)
def test_the_evaluation_knows_those_that_it_had(fails, flag):
    assert f"is now --option {flag[2:]}=0.5" in fails("evaluate", ".", flag, "0.5", code=2)


def test_the_new_spellings_are_options():
    keys = {switch.key for switch in SWITCHES}
    assert {flag[2:] for flag in VALUED} | {text.partition("=")[0] for text in SWITCHED.values()} <= keys
    assert read_options([*SWITCHED.values(), "joins=biconnected"]) != Options()


@pytest.mark.parametrize("command", [*PHOTO_COMMANDS, "evaluate"])
def test_no_help_shows_them(command, capsys):
    with pytest.raises(SystemExit, match="0"):
        main([command, "--help"])
    shown = capsys.readouterr().out.split()
    kept = ["--formulation"] if command == "evaluate" else []
    assert [flag for flag in ALL if flag in shown and flag not in kept] == []
