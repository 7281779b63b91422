"""`linecad export`: files from a scene file, with its photo where a format shows it."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from exporters.formats import FORMATS
from linecad.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
ROOM = SAMPLES / "room.jpg"
COURTYARD = SAMPLES / "courtyard.jpg"
posix = pytest.mark.skipif(os.name == "nt", reason="signals, links and limits as on POSIX")


@pytest.mark.parametrize("loss", [("--detail", "none"), ("--confidence", "0.5"), ("--groups", "main")])
def test_the_scene_file_is_not_overwritten_by_a_part_of_it(fails, folder, scene_file, loss):
    shutil.copy(scene_file, folder)
    assert "is an input too" in fails("export", "room.json", "-o", "a.obj", "-o", "room.json", *loss)


def test_a_scale_is_set_in_place(folder, scene_file):
    shutil.copy(scene_file, folder)
    line = json.loads(scene_file.read_text())["lines"][7]["id"]
    assert main(["export", "room.json", "--scale", f"{line}=3", "-o", "room.json", "--quiet"]) == 0
    before, after = (json.loads((where / "room.json").read_text()) for where in (scene_file.parent, folder))
    assert (before["metres_per_unit"], after["lines"]) == (None, before["lines"])
    assert after["metres_per_unit"] > 0


def test_a_scale_that_cannot_be_set_in_place_changes_nothing(fails, folder, scene_file):
    shutil.copy(scene_file, folder)
    assert "no line 99999" in fails("export", "room.json", "--scale", "99999=3", "-o", "room.json")


@pytest.mark.parametrize("text", ["", "{", "{}", "[1]", '{"format": "linecad-scene", "version": 99}', "\x00\xff"])
def test_broken_scene_files(fails, folder, text):
    (folder / "broken.json").write_text(text, encoding="latin-1")
    assert "broken.json" in fails("export", "broken.json", "-o", "a.step")


def test_a_scene_file_cut_off_in_the_middle(fails, folder, scene_file):
    (folder / "cut.json").write_bytes(scene_file.read_bytes()[:5000])
    assert "cut.json" in fails("export", "cut.json", "-o", "a.obj")


def test_export_without_a_scene(fails):
    assert "no scene file was given" in fails("export", "-o", "a.step")


def test_formats_lists_every_suffix(capsys):
    assert main(["export", "--formats"]) == 0
    out, err = capsys.readouterr()
    assert [line.split()[0] for line in out.splitlines() if line.startswith(".")] == [".json", *FORMATS]
    assert err == ""


def test_formats_lists_every_option_with_its_default(capsys):
    main(["export", "--formats"])
    listed = [line.strip() for line in capsys.readouterr().out.splitlines() if line.startswith(" ")]
    expected = [option for row in FORMATS.values() for option in row.options]
    assert len(listed) == len(expected) >= 3
    for line, option in zip(listed, expected, strict=True):
        assert line.startswith(f"--option {option.key}={option.usual}: ")
        assert option.accepted in line


@pytest.mark.parametrize(
    ("option", "words"),
    [
        (["--scale", "12"], "is no length; write it like 840,310:840,655=2.1 or 45237=3.5"),
        (["--scale", "=3"], "'' is neither the id of a line nor two px"),
        (["--scale", "12="], "'' is not a number"),
        (["--scale", "12=0"], "0 is not a positive number"),
        (["--scale", "12=inf"], "inf is not a number of zero or more"),
        (["--scale=-1=2"], "neither the id of a line"),
        (["--scale", "1,2:3=2"], "neither the id of a line"),
        (["--scale", "1,2,3,4=2"], "neither the id of a line"),
        (["--scale", "1,2:3,x=2"], "'x' is not a number of px"),
        (["--scale", "1,2:3,nan=2"], "nan px lies outside every photo"),
        (["--main", "12"], "'12' is no place in a photo; write it like 840,310"),
        (["--main", "1,nan"], "nan px lies outside every photo"),
        (["--groups", "some"], "invalid choice: 'some'"),
        (["--camera-height", "-2"], "-2 is not a number of zero or more"),
        (["--camera-height", "2", "--scale", "1=2"], "not allowed with"),
    ],
)
def test_a_length_that_is_none_is_wrong_usage(fails, scene_file, option, words):
    assert words in fails("export", scene_file, "-o", "a.json", *option, code=2)


def test_a_line_that_is_not_there_cannot_be_measured(fails, scene_file):
    assert "no line 99999" in fails("export", scene_file, "-o", "a.json", "--scale", "99999=2")


def test_a_known_length_scales_the_files_and_not_the_scene(folder, scene_file):
    before = json.loads(scene_file.read_text())
    # The ends of a long line reach hardly farther than its segment.
    line = max(before["lines"], key=lambda line: np.linalg.norm(np.subtract(*line["segment"])))
    length = float(np.linalg.norm(np.subtract(*line["ends"])))
    arguments = ["-o", "a.json", "-o", "a.obj", "-o", "a.dxf", "--scale", f"{line['id']}={length / 4}", "--quiet"]
    assert main(["export", str(scene_file), *arguments]) == 0
    after = json.loads((folder / "a.json").read_text())
    assert after["metres_per_unit"] == pytest.approx(0.25)
    assert after["lines"] == before["lines"]
    assert after["planes"] == before["planes"]
    (u, v), (x, y) = line["segment"]
    arguments = ["-o", "b.json", "--scale", f"{u},{v}:{x},{y}={length / 4}", "--quiet"]
    assert main(["export", str(scene_file), *arguments]) == 0
    assert json.loads((folder / "b.json").read_text())["metres_per_unit"] == pytest.approx(0.25, rel=0.2)
    assert "lengths are in metres" in (folder / "a.obj").read_text()


def test_an_option_reaches_its_format(folder, scene_file):
    outputs = ["-o", "a.dxf", "-o", "a.glb", "-o", "a.json"]
    options = ["--option", "version=R2018", "--option", "tubes=on"]
    assert main(["export", str(scene_file), *outputs, *options, "--quiet"]) == 0
    assert main(["export", str(scene_file), "-o", "b.dxf", "-o", "b.glb", "--quiet"]) == 0
    versions = [(folder / name).read_text()[:400].count("AC1032") for name in ("a.dxf", "b.dxf")]
    assert versions == [1, 0]
    assert (folder / "a.glb").stat().st_size > (folder / "b.glb").stat().st_size


@pytest.mark.usefixtures("folder")
def test_without_the_photo_the_faces_have_no_textures_and_a_line_says_so(scene_file, capsys):
    assert main(["export", str(scene_file), "-o", "a.obj", "-o", "a.glb", "--quiet"]) == 0
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert "room.jpg" in said[0]
    assert "--photo" in said[0]
    assert said[0].endswith("the faces have no textures")
    assert main(["export", str(scene_file), "-o", "b.obj", "--option", "textures=off", "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    assert Path("a.obj").read_bytes() == Path("b.obj").read_bytes()


def test_textures_that_were_asked_for_need_the_photo(folder, scene_file, capsys):
    assert main(["export", str(scene_file), "-o", "a.glb", "--option", "textures=on", "--quiet"]) == 1
    assert "textures were asked for, but the photo 'room.jpg' is not beside" in capsys.readouterr().err
    assert list(folder.iterdir()) == []


def test_textures_find_the_photo_beside_the_scene_or_by_its_name(folder, scene_file, capsys):
    assert main(["export", str(scene_file), "--photo", str(ROOM), "-o", "a.obj", "--quiet"]) == 0
    shutil.copy(scene_file, folder / "room.json")
    shutil.copy(ROOM, folder / "room.jpg")
    assert main(["export", "room.json", "-o", "b.obj", "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    pictures = [sorted(path.name for path in (folder / f"{name}.obj.textures").iterdir()) for name in "ab"]
    assert pictures[0] == pictures[1]
    assert len(pictures[0]) == 1


@pytest.mark.thorough
def test_a_photo_that_its_own_lines_straightened_is_straightened_again_for_its_textures(folder, capsys):
    """The courtyard without its camera file: the scene alone says by how much."""
    shutil.copy(COURTYARD, folder / "courtyard.jpg")
    assert main(["convert", "courtyard.jpg", "-o", "a.json", "-o", "at-once.obj", "--fast", "--quiet"]) == 0
    assert main(["export", "a.json", "-o", "later.obj", "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    scene = json.loads((folder / "a.json").read_text(encoding="utf-8"))
    assert scene["camera"]["source"] == "vanishing points"
    assert len(scene["camera"]["distortion"]) == 4
    scene["camera"]["distortion"] = []
    (folder / "unbent.json").write_text(json.dumps(scene), encoding="utf-8")
    assert main(["export", "unbent.json", "-o", "bent.obj", "--quiet"]) == 0
    at_once, later, bent = (
        np.asarray(Image.open(next((folder / f"{name}.obj.textures").iterdir())), int)
        for name in ("at-once", "later", "bent")
    )
    assert np.abs(at_once - later).max() <= 2
    assert np.abs(at_once - bent).mean() > 2


@pytest.mark.usefixtures("folder")
def test_a_wrong_photo_is_an_error_where_it_was_named_and_a_line_where_it_was_found(scene_file, folder, capsys):
    Image.new("RGB", (400, 300)).save(folder / "other.png")
    assert main(["export", str(scene_file), "--photo", "other.png", "-o", "a.glb", "--quiet"]) == 1
    assert "has 400 x 300 px" in capsys.readouterr().err
    shutil.copy(scene_file, folder / "room.json")
    Image.new("RGB", (400, 300)).save(folder / "room.jpg")
    assert main(["export", "room.json", "-o", "a.glb", "--quiet"]) == 0
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert "has 400 x 300 px" in said[0]
    assert said[0].endswith("the faces have no textures")


def test_an_exported_scene_file_is_the_same(folder, scene_file):
    assert main(["export", str(scene_file), "-o", "again.json", "--quiet"]) == 0
    assert (folder / "again.json").read_bytes() == scene_file.read_bytes()


@pytest.mark.thorough
def test_the_picture_finds_the_photo_beside_the_scene(folder, scene_file):
    shutil.copy(scene_file, folder / "room.json")
    assert main(["export", "room.json", "-o", "without.png", "--quiet"]) == 0
    shutil.copy(ROOM, folder)
    assert main(["export", "room.json", "-o", "beside.png", "--quiet"]) == 0
    (folder / "room.jpg").unlink()
    assert main(["export", "room.json", "--photo", str(ROOM), "-o", "named.png", "--quiet"]) == 0
    assert (folder / "beside.png").read_bytes() == (folder / "named.png").read_bytes()
    assert (folder / "beside.png").read_bytes() != (folder / "without.png").read_bytes()


WITH_A_SMALL_DISK = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
from linecad.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


@posix
@pytest.mark.parametrize("output", ["a.json", "a.obj"])
def test_a_full_disk_leaves_what_was_there(folder, scene_file, output):
    (folder / output).write_text("from yesterday")
    command = [sys.executable, "-c", WITH_A_SMALL_DISK, "export", str(scene_file), "-o", output, "--quiet"]
    ended = subprocess.run(
        command, cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    assert ended.returncode == 1
    assert ended.stderr.splitlines()[-1] == (
        f"linecad: {output} was not written: no space is left for it; free some or choose another disk"
    )
    assert (folder / output).read_text() == "from yesterday"
    assert [path.name for path in folder.rglob("*") if path.name.startswith(".linecad-")] == []


def test_a_photo_of_another_size_is_refused_for_the_picture(scene_file, folder, capsys):
    Image.new("RGB", (400, 300)).save("other.png")
    assert main(["export", str(scene_file), "--photo", "other.png", "-o", "a.png", "--quiet"]) == 1
    assert "has 400 x 300 px, the scene's photo 1600 x 1067" in capsys.readouterr().err
    assert not (folder / "a.png").exists()


def test_a_calibration_that_is_not_the_scenes_is_refused_for_the_picture(scene_file, folder, capsys):
    arguments = ["--photo", str(SAMPLES / "courtyard.jpg"), "--camera", str(SAMPLES / "courtyard.json")]
    assert main(["export", str(scene_file), *arguments, "-o", "a.png", "--quiet"]) == 1
    assert "not the calibration that the scene was made with" in capsys.readouterr().err
    assert not (folder / "a.png").exists()


def test_a_scene_file_sends_nobody_to_another_folder(scene_file, folder):
    (folder / "inside").mkdir()
    shutil.copy(ROOM, folder / "secret.jpg")
    text = scene_file.read_text(encoding="utf-8").replace('"room.jpg"', '"../secret.jpg"')
    (folder / "inside" / "scene.json").write_text(text, encoding="utf-8")
    assert main(["export", "inside/scene.json", "-o", "without.png", "--quiet"]) == 0
    assert main(["export", "inside/scene.json", "--photo", "secret.jpg", "-o", "with.png", "--quiet"]) == 0
    assert (folder / "without.png").read_bytes() != (folder / "with.png").read_bytes()


@pytest.fixture
def told(scene_file, folder):
    """The scene with probabilities: 0.95 for the first half of its lines, 0.6 for the others."""
    scene = json.loads(scene_file.read_text(encoding="utf-8"))
    for number, line in enumerate(scene["lines"]):
        line["probability"] = 0.95 if 2 * number < len(scene["lines"]) else 0.6
    (folder / "told.json").write_text(json.dumps(scene), encoding="utf-8")
    return scene


def test_lines_that_are_not_sure_enough_are_in_no_file(folder, told):
    outputs = ["-o", "a.json", "-o", "a.obj", "--option", "textures=off"]
    assert main(["export", "told.json", *outputs, "--confidence", "0.9", "--quiet"]) == 0
    kept = json.loads((folder / "a.json").read_text(encoding="utf-8"))
    assert kept["lines"] == [line for line in told["lines"] if line["probability"] > 0.9]
    gone = len(told["lines"]) - len(kept["lines"])
    assert kept["notes"][-1].startswith(f"{gone} of {len(told['lines'])} lines")
    assert (folder / "a.obj").read_text().count("\nl ") == len(kept["lines"])


def test_a_line_that_is_left_out_still_sets_the_scale(folder, told):
    arguments = ["--scale", f"{told['lines'][-1]['id']}=2", "--confidence", "0.9", "--quiet"]
    assert main(["export", "told.json", "-o", "a.json", *arguments]) == 0
    assert json.loads((folder / "a.json").read_text(encoding="utf-8"))["metres_per_unit"] is not None


def test_a_scale_from_a_line_whose_depth_is_a_guess_says_so(folder, told):
    told["lines"][-1]["probability"] = 0.4
    (folder / "told.json").write_text(json.dumps(told), encoding="utf-8")
    arguments = ["--scale", f"{told['lines'][-1]['id']}=2", "--quiet"]
    assert main(["export", "told.json", "-o", "a.json", *arguments]) == 0
    assert "at a depth that is a guess" in json.loads((folder / "a.json").read_text(encoding="utf-8"))["scale_source"]


@pytest.mark.usefixtures("told")
@pytest.mark.parametrize("text", ["1.5", "-0.1", "nan", "inf", "much", "90%"])
def test_a_confidence_that_is_no_probability_is_wrong_usage(fails, text):
    said = fails("export", "told.json", "-o", "a.json", f"--confidence={text}", code=2)
    assert f"'{text}' is not a number from 0 to 1" in said


@pytest.mark.usefixtures("told")
def test_a_confidence_that_no_line_has(fails):
    assert "the highest is 0.95; choose a smaller" in fails("export", "told.json", "-o", "a.json", "--confidence", "1")


def test_a_scene_that_does_not_tell_has_no_confidence(fails, scene_file, folder):
    scene = json.loads(scene_file.read_text(encoding="utf-8"))
    for line in scene["lines"]:
        line.pop("probability", None)
    (folder / "silent.json").write_text(json.dumps(scene), encoding="utf-8")
    assert "leave out --confidence" in fails("export", "silent.json", "-o", "a.json", "--confidence", "0.5")


@pytest.fixture
def drawn(scene_file, folder):
    """The scene with lines of all roles."""
    scene = json.loads(scene_file.read_text(encoding="utf-8"))
    for number, line in enumerate(scene["lines"]):
        line["role"] = ("outline", "opening", "detail")[number % 3]
    (folder / "drawn.json").write_text(json.dumps(scene), encoding="utf-8")
    return scene


@pytest.mark.parametrize(
    ("given", "roles"),
    [
        (["--detail", "none"], {"outline"}),
        (["--detail", "openings"], {"outline", "opening"}),
        (["--detail", "all"], {"outline", "opening", "detail"}),
        ([], {"outline", "opening", "detail"}),
    ],
)
def test_detail_chooses_the_lines_of_every_file(folder, drawn, given, roles):
    outputs = ["-o", "a.json", "-o", "a.obj", "--option", "textures=off"]
    assert main(["export", "drawn.json", *outputs, *given, "--quiet"]) == 0
    kept = json.loads((folder / "a.json").read_text(encoding="utf-8"))
    assert [line["id"] for line in kept["lines"]] == [line["id"] for line in drawn["lines"] if line["role"] in roles]
    assert (folder / "a.obj").read_text().count("\nl ") == len(kept["lines"])


@pytest.mark.usefixtures("drawn")
def test_a_detail_that_is_none_of_the_words_is_wrong_usage(fails):
    assert "'some'" in fails("export", "drawn.json", "-o", "a.json", "--detail", "some", code=2)


@pytest.mark.parametrize("command", ["export", "elevation"])
def test_the_photo_of_the_scene_is_not_written_over(folder, scene_file, capsys, command):
    """A picture of the scene took the place of the photo beside it."""
    name = "room.png" if command == "export" else "room.tif"
    scene = json.loads(scene_file.read_text()) | {"photo": name}
    (folder / "own.json").write_text(json.dumps(scene))
    (folder / name).write_bytes(b"the only one")
    assert main([command, "own.json", "-o", name, "--quiet"]) == 1
    assert "is an input too and would be lost" in capsys.readouterr().err
    assert (folder / name).read_bytes() == b"the only one"
