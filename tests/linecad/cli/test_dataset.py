"""What `linecad dataset` refuses about depth maps, in one line and before anything is made."""

import pytest

MADE = ("dataset", "made", "--scenes", "1", "--seed", "1")


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (["--depth-maps", "0.012"], 1, "0.012 % was asked for, 0.1 to 20 % are possible"),
        (["--depth-maps", "21"], 1, "21 % was asked for, 0.1 to 20 % are possible"),
        (["--depth-maps", "0"], 2, "0 is not a positive number"),
        (["--depth-maps", "nan"], 2, "nan is not a number"),
        (["--depth-maps", "folder"], 2, "'folder' is not a number"),
        (["--depth-maps", "1.2%"], 2, "'1.2%' is not a number"),
        (["--depth-maps", "--depth-kind", "distance"], 2, "invalid choice: 'distance'"),
        (["--depth-kind", "z"], 1, "add --depth-maps"),
    ],
)
def test_wrong_depth_maps(fails, folder, options, code, words):
    assert words in fails(*MADE, *options, code=code)
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        (["--towns", "--gardens"], 2, "not allowed with argument --towns"),
        (["--gardens", "--buildings", "b.json", "--cameras", "c.json"], 1, "leave --scenes, --towns and --gardens out"),
    ],
)
def test_one_kind_of_scenes(fails, folder, options, code, words):
    asked = MADE if "--buildings" not in options else MADE[:2]
    assert words in fails(*asked, *options, code=code)
    assert list(folder.iterdir()) == []
