"""The command line: what it refuses, in one line, and what it never leaves behind."""

import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import threading
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from exporters.formats import FORMATS
from linecad import __version__
from linecad.camera.refit import find_calibration
from linecad.cli.main import main
from linecad.io.scene_file import read_scene
from linecad.lines.segments import find_segments
from solver.options import BACKENDS, FORMULATIONS

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
ROOM = SAMPLES / "room.jpg"
COURTYARD = SAMPLES / "courtyard.jpg"
posix = pytest.mark.skipif(os.name == "nt", reason="signals, links and limits as on POSIX")


def run_as_module(arguments, folder, **more):
    """`python -m linecad` in a process of its own, started in `folder`."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "linecad", *map(str, arguments)]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=100, check=False, **more
    )


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def fails(folder, capsys):
    """A function that runs the command, expects it to fail in one line and to change no file, and gives that line."""

    def contents():
        return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}

    def run(*arguments, code=1):
        before = contents()
        try:
            ended = main([*map(str, arguments), "--quiet"])
        except SystemExit as leaving:  # argparse leaves so
            ended = leaving.code
        out, err = capsys.readouterr()
        assert ended == code
        assert out == ""
        assert contents() == before
        assert err.endswith("\n")
        assert err.startswith("linecad")
        assert len(err.splitlines()) == 1, err
        return err.strip()

    return run


@pytest.fixture(scope="module")
def scene_file(tmp_path_factory):
    """The scene of a sample photo."""
    path = tmp_path_factory.mktemp("scene") / "room.json"
    assert main(["convert", str(ROOM), "-o", str(path), "--quiet", "--largest-component"]) == 0
    return path


def png_that_claims(width, height):
    """A PNG with a header and no pixels."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


def stripes():
    """Parallel edges that meet in one vanishing point, and nothing else."""
    image = np.full((600, 800), 220, np.uint8)
    for u in range(-1200, 2000, 160):
        corners = np.array([[400 + (u - 400) * 0.25, -10], [400 + (u - 320) * 0.25, -10], [u + 80, 610], [u, 610]])
        cv2.fillPoly(image, [np.round(corners * 16).astype(np.int32)], 60, cv2.LINE_AA, shift=4)
    return image


def lonely_lines():
    """Long thin lines of two directions that stay far from each other."""
    image = np.full((900, 1200), 220, np.uint8)
    for i in range(8):
        image[60 + 100 * i : 63 + 100 * i, 80:400] = 40
        image[80:800, 560 + 80 * i : 563 + 80 * i] = 40
    return image


BAD_PHOTOS = {
    "text": (lambda: b"no picture, just words\n" * 20, "is not an image that linecad can read"),
    "empty": (lambda: b"", "is empty"),
    "truncated": (lambda: ROOM.read_bytes()[:60_000], "is damaged or incomplete"),
    "huge": (lambda: png_that_claims(20_000, 10_001), "200 megapixels"),
}


@pytest.mark.parametrize("name", BAD_PHOTOS)
def test_files_that_are_no_photo(fails, folder, name):
    content, words = BAD_PHOTOS[name]
    (folder / "photo.png").write_bytes(content())
    said = fails("convert", "photo.png", "-o", "a.json", "-o", "a.step")
    assert "photo.png" in said
    assert words in said


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (lambda: np.full((100, 63), 128, np.uint8), "64"),
        (lambda: np.full((480, 640), 128, np.uint8), "0 straight segments found"),
        (stripes, "run in one direction"),
        (lonely_lines, "hardly touch each other"),
    ],
    ids=["tiny", "flat", "stripes", "lonely lines"],
)
def test_photos_that_show_too_little(fails, folder, draw, words):
    Image.fromarray(draw()).save(folder / "photo.png")
    assert words in fails("convert", "photo.png", "--focal", "900" if words != "64" else "90", "-o", "a.json")


def test_a_photo_that_is_not_there(fails):
    assert "nowhere.jpg" in fails("convert", "nowhere.jpg", "-o", "a.json")


@pytest.mark.parametrize(
    ("camera", "words"),
    [
        ("{", "camera.json"),
        ("[]", "camera.json"),
        ('{"width": 1600, "height": 1067}', "K"),
        ('{"width": 1600, "height": 1067, "K": [[1, 2], [3, 4]]}', "K"),
        ('{"width": 800, "height": 600, "K": [[700, 0, 400], [0, 700, 300], [0, 0, 1]]}', "800 x 600"),
        ('{"width": 1600, "height": 1067, "K": [[NaN, 0, 800], [0, 700, 500], [0, 0, 1]]}', "camera.json"),
    ],
)
def test_camera_files_that_do_not_fit(fails, folder, camera, words):
    (folder / "camera.json").write_text(camera)
    assert words in fails("convert", ROOM, "--camera", "camera.json", "-o", "a.json")


@pytest.mark.parametrize(
    ("outputs", "words"),
    [
        ([], "no output was named"),
        (["a.doc"], "unknown suffix .doc"),
        (["scene"], "no suffix"),
        (["a.json", "a.doc"], "unknown suffix .doc"),
        (["missing/a.json"], "does not exist"),
        (["a.json", "./a.json"], "named twice"),
        (["a.json", "."], "suffix"),
        (["folder.step"], "is a folder"),
    ],
)
@pytest.mark.parametrize("command", ["convert", "export"])
def test_outputs_that_cannot_be(fails, folder, scene_file, command, outputs, words):
    (folder / "folder.step").mkdir()
    options = [word for output in outputs for word in ("-o", output)]
    assert words in fails(command, ROOM if command == "convert" else scene_file, *options)


@posix
@pytest.mark.usefixtures("bound_by_permissions")
def test_a_folder_that_cannot_be_written(fails, folder):
    locked = folder / "locked"
    locked.mkdir()
    locked.chmod(0o555)
    assert "cannot be written" in fails("convert", ROOM, "-o", "locked/a.json")


def test_the_photo_is_never_overwritten(fails, folder):
    Image.open(ROOM).save(folder / "photo.png")
    assert "is an input too" in fails("convert", "photo.png", "-o", "photo.png")


@posix
def test_the_photo_is_never_overwritten_through_a_link(fails, folder):
    Image.open(ROOM).save(folder / "photo.png")
    (folder / "link.png").symlink_to("photo.png")
    os.link(folder / "photo.png", folder / "hard.png")
    assert "is an input too" in fails("convert", "photo.png", "-o", "link.png")
    assert "is an input too" in fails("convert", "link.png", "-o", "photo.png")
    assert "is an input too" in fails("convert", "photo.png", "-o", "hard.png")


def test_the_camera_file_is_never_overwritten(fails, folder):
    shutil.copy(SAMPLES / "room.json", folder)
    assert "is an input too" in fails("convert", ROOM, "--camera", "room.json", "-o", "room.json")


def test_the_scene_file_is_never_overwritten(fails, folder, scene_file):
    shutil.copy(scene_file, folder)
    assert "is an input too" in fails("export", "room.json", "-o", "a.obj", "-o", "room.json")


@pytest.mark.parametrize("text", ["", "{", "{}", "[1]", '{"format": "linecad-scene", "version": 99}', "\x00\xff"])
def test_broken_scene_files(fails, folder, text):
    (folder / "broken.json").write_text(text, encoding="latin-1")
    assert "broken.json" in fails("export", "broken.json", "-o", "a.step")


def test_a_scene_file_cut_off_in_the_middle(fails, folder, scene_file):
    (folder / "cut.json").write_bytes(scene_file.read_bytes()[:5000])
    assert "cut.json" in fails("export", "cut.json", "-o", "a.obj")


def test_export_without_a_scene(fails):
    assert "no scene file was given" in fails("export", "-o", "a.step")


def test_numbers_that_the_solver_cannot_use(fails):
    assert "mu_boundary is 1e+300" in fails("convert", ROOM, "-o", "a.json", "--mu-boundary", "1e300")
    assert "time_limit_s is 1e+300" in fails("convert", ROOM, "-o", "a.json", "--time-limit", "1e300")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--without", "nonsense"], "'nonsense' is no family of constraints; use cycles, planarity, boundary"),
        (["--focal", "abc"], "'abc' is not a number"),
        (["--focal", "0"], "0 is not a positive number"),
        (["--focal", "nan"], "nan is not a number of zero or more"),
        (["--focal=-5"], "-5 is not a number of zero or more"),
        (["--time-limit", "inf"], "inf is not a number of zero or more"),
        (["--seed", "1.5"], "'1.5' is no seed"),
        (["--seed", "-1"], "'-1' is no seed; give a whole number from 0 to 2147483647"),
        (["--seed", "2147483648"], "'2147483648' is no seed"),
        (["--weights", "heavy"], "--weights"),
        (["--formulation", "other"], "--formulation"),
        (["--focal", "900", "--camera", "room.json"], "not allowed with"),
        (["--verbose"], "not allowed with"),  # together with --quiet
        (["--unknown"], "--unknown"),
        (["second.jpg"], "second.jpg"),
    ],
)
def test_wrong_usage_is_exit_code_2(fails, options, words):
    assert words in fails("convert", ROOM, "-o", "a.json", *options, code=2)


@pytest.mark.parametrize("arguments", [[], ["invent"], ["convert"]])
def test_commands_that_say_too_little(fails, arguments):
    assert "--help" in fails(*arguments, code=2)


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
    ("output", "option", "words"),
    [
        ("a.glb", "tubes", "no value; write it like KEY=VALUE"),
        ("a.glb", "tubes=perhaps", "option tubes is 'perhaps', expected on or off"),
        ("a.dxf", "version=R12", "option version is 'R12', expected R2010 or R2018"),
        ("a.glb", "tube=on", "no option 'tube' for .glb, which has tubes"),
        ("a.step", "tubes=on", "no option 'tubes' for .step"),
        ("a.stl", "tubes=on", "for .stl, which has no options"),
        ("a.json", "tubes=on", "no option 'tubes' for the scene file, which has no options"),
    ],
)
@pytest.mark.parametrize("command", ["convert", "export"])
def test_a_bad_option_is_refused_before_the_work(fails, scene_file, command, output, option, words):
    source = ROOM if command == "convert" else scene_file
    assert words in fails(command, source, "-o", output, "--option", option)


@pytest.mark.parametrize(
    ("option", "words"),
    [
        (["--scale", "12"], "is no length; write it like 12=3.5"),
        (["--scale", "=3"], "'' is neither the id of a line nor two px"),
        (["--scale", "12="], "'' is not a number"),
        (["--scale", "12=0"], "0 is not a positive number"),
        (["--scale", "12=inf"], "inf is not a number of zero or more"),
        (["--scale=-1=2"], "neither the id of a line"),
        (["--scale", "1,2:3=2"], "neither the id of a line"),
        (["--scale", "1,2,3,4=2"], "neither the id of a line"),
        (["--scale", "1,2:3,x=2"], "'x' is not a number of px"),
        (["--scale", "1,2:3,nan=2"], "nan px lies outside every photo"),
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
    line = before["lines"][7]
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


def test_version_and_help(folder):
    version = run_as_module(["--version"], folder)
    assert (version.returncode, version.stdout, version.stderr) == (0, f"linecad {__version__}\n", "")
    usage = run_as_module(["--help"], folder)
    assert (usage.returncode, usage.stderr) == (0, "")
    assert "convert" in usage.stdout
    assert "export" in usage.stdout


def test_every_option_is_explained(capsys):
    for command in ("convert", "camera", "export"):
        with pytest.raises(SystemExit, match="0"):
            main([command, "--help"])
        text = capsys.readouterr().out
        assert "example: linecad " + command in text
        assert "--output" in text


@pytest.mark.parametrize("name", ["solver", "exporters"])
def test_a_file_that_hides_a_package_is_named(folder, name):
    (folder / f"{name}.py").write_text("raise RuntimeError('never to be run')\n")
    ended = run_as_module(["convert", ROOM, "-o", "a.json"], folder)
    assert ended.returncode == 1
    assert len(ended.stderr.splitlines()) == 1
    assert str((folder / f"{name}.py").resolve()) in ended.stderr
    assert [path.name for path in folder.iterdir() if path.name != "__pycache__"] == [f"{name}.py"]


@pytest.mark.usefixtures("folder")
def test_progress_goes_to_stderr_a_line_a_stage(scene_file, capsys):
    assert main(["export", str(scene_file), "-o", "a.stl", "-o", "b.json"]) == 0
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == ["reading the scene", "writing a.stl", "writing b.json"]


@pytest.mark.usefixtures("folder")
def test_quiet_says_nothing_and_verbose_the_times(scene_file, capsys):
    assert main(["export", str(scene_file), "-o", "a.stl", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert main(["export", str(scene_file), "-o", "a.stl", "--verbose"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(" s  ")[1] for line in lines] == ["reading the scene", "writing a.stl"]


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


@pytest.fixture
def edited(monkeypatch):
    """A function that gives the camera and the quality with which `linecad edit` would begin."""

    def begin(*arguments):
        seen = []
        monkeypatch.setattr("linecad.editing.run.edit", lambda photo, *_: seen.append(photo))
        assert main(["edit", *arguments, "--no-browser", "--quiet"]) == 0
        found = find_calibration(seen[0], find_segments(seen[0].grey))
        return found.camera, found.certainty

    return begin


@pytest.mark.parametrize(
    ("photo", "options", "source"),
    [(ROOM, [], "exif"), (COURTYARD, [], "vanishing points"), (COURTYARD, ["--focal", "1040"], "focal option")],
)
def test_the_page_of_a_scene_begins_with_the_camera_of_the_scene(folder, edited, photo, options, source):
    """It once forgot what EXIF had said, and by how much the photo had been straightened."""
    shutil.copy(photo, folder)
    assert main(["convert", photo.name, "-o", "scene.json", "--fast", "--quiet", *options]) == 0
    scene = read_scene(folder / "scene.json")
    camera, certainty = edited("scene.json")
    assert camera.source == scene.camera.source == source
    assert camera.matrix == pytest.approx(scene.camera.matrix)
    assert camera.distortion == pytest.approx(scene.camera.distortion)
    assert bool(camera.distortion) == (photo is COURTYARD)
    assert certainty.quality == scene.certainty.quality
    assert certainty.focal == pytest.approx(scene.certainty.focal)


def test_the_page_of_a_scene_takes_another_focal_length(folder, edited, scene_file):
    shutil.copy(scene_file, folder / "scene.json")
    camera, _ = edited("scene.json", "--photo", str(ROOM), "--focal", "950")
    assert (camera.source, camera.focal) == ("focal option", 950.0)


def test_the_page_of_a_scene_refuses_a_photo_of_another_size(fails, folder, scene_file):
    shutil.copy(scene_file, folder / "scene.json")
    Image.new("RGB", (400, 300)).save(folder / "other.png")
    assert "has 400 x 300 px, the scene's photo 1600 x 1067" in fails("edit", "scene.json", "--photo", "other.png")


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


def test_the_picture_finds_the_photo_beside_the_scene(folder, scene_file):
    shutil.copy(scene_file, folder / "room.json")
    assert main(["export", "room.json", "-o", "without.png", "--quiet"]) == 0
    shutil.copy(ROOM, folder)
    assert main(["export", "room.json", "-o", "beside.png", "--quiet"]) == 0
    (folder / "room.jpg").unlink()
    assert main(["export", "room.json", "--photo", str(ROOM), "-o", "named.png", "--quiet"]) == 0
    assert (folder / "beside.png").read_bytes() == (folder / "named.png").read_bytes()
    assert (folder / "beside.png").read_bytes() != (folder / "without.png").read_bytes()


@posix
def test_an_error_on_a_terminal_stands_on_a_line_of_its_own(folder):
    import pty

    (folder / "photo.png").write_bytes(b"")
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "linecad", "convert", "photo.png", "-o", "a.json"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(command, cwd=folder, env=environment, stderr=theirs, timeout=60, check=False)
    os.close(theirs)
    shown = os.read(ours, 100_000).decode()
    os.close(ours)
    assert ended.returncode == 1
    assert "reading the photo ...\r\033[Klinecad: photo.png" in shown


WITH_A_SMALL_DISK = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
from linecad.cli import main
from solver.options import BACKENDS, FORMULATIONS
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


def interrupt(arguments, folder, moment):
    """Run the command on a terminal and press Ctrl-C when that shows `moment`: exit code, stdout and what it showed."""
    import pty

    ours, theirs = pty.openpty()
    child = subprocess.Popen(
        [sys.executable, "-m", "linecad", *map(str, arguments)], cwd=folder, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE, stderr=theirs,
    )  # fmt: skip
    os.close(theirs)
    watchdog = threading.Timer(300, child.kill)
    watchdog.start()
    shown, is_sent = b"", False
    try:
        while piece := read_terminal(ours):
            shown += piece
            if moment in shown.decode(errors="replace") and not is_sent:
                child.send_signal(signal.SIGINT)
                is_sent = True
        return child.wait(), child.stdout.read(), shown.decode()
    finally:
        watchdog.cancel()
        child.kill()
        child.wait()
        child.stdout.close()
        os.close(ours)


def read_terminal(descriptor):
    """What a terminal shows next, nothing when its programs have ended."""
    try:
        return os.read(descriptor, 4096)
    except OSError:  # Linux says so in this way
        return b""


@posix
def test_ctrl_c_keeps_the_best_answer_and_writes_the_files(folder):
    street = [SAMPLES / "street.jpg", "--camera", SAMPLES / "street.json", "--extension", 90, "--mu-boundary", 1]
    code, out, _ = interrupt(["convert", *street, "-o", "a.json", "-o", "a.obj"], folder, "Ctrl-C keeps the best")
    assert code == 0
    scene = json.loads((folder / "a.json").read_text())
    assert scene["solve"]["status"] == "interrupted"
    assert any("was interrupted" in note for note in scene["notes"])
    assert len(scene["lines"]) > 100
    assert "interrupted in " in out
    assert sorted(path.name for path in folder.iterdir()) == ["a.json", "a.obj", "a.obj.mtl", "a.obj.textures"]


@posix
def test_ctrl_c_before_the_solver_writes_nothing(folder):
    code, out, shown = interrupt(["convert", ROOM, "-o", "a.json"], folder, "reading the photo")
    assert code == 1
    assert out == ""
    assert shown.splitlines()[-1].endswith(
        "\033[Klinecad: interrupted; a file that was not written yet is as it was before"
    )
    assert "Traceback" not in shown
    assert list(folder.iterdir()) == []


def test_choices_are_those_of_the_solver(capsys):
    # The command line spells them out so that --help need not load the solver.
    assert main_code(["convert", "--help"]) == 0
    text = capsys.readouterr().out
    assert "{" + ",".join(FORMULATIONS) + "}" in text
    assert "{" + ",".join(BACKENDS) + "}" in text


def test_an_extension_that_lets_all_lines_cross_is_refused(capsys):
    assert main_code(["convert", "a.jpg", "-o", "a.dxf", "--extension", "1e9"]) == 2
    assert "at most 500" in capsys.readouterr().err


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


def main_code(arguments):
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    return ended.value.code


def test_camera_prints_what_it_found(capsys):
    assert main(["camera", str(ROOM), "--quiet"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    names = [line[:19].strip() for line in out.splitlines()]
    assert names[:4] == ["photo", "quality", "focal length", "field of view"]


def test_camera_writes_all_its_files_and_says_how_good_it_is(folder, capsys):
    outputs = ["a.json", "a.fspy", "a.png"]
    assert main(["camera", str(ROOM), *(part for name in outputs for part in ("-o", name))]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines()[0].startswith("camera ")
    assert err.splitlines()[-1] == "writing a.png"
    assert sorted(path.name for path in folder.iterdir()) == sorted(outputs)


def test_convert_with_the_written_camera_has_the_same_frame(folder, capsys):
    assert main(["camera", str(ROOM), "-o", "camera.json", "--quiet"]) == 0
    for name, more in (("a.json", []), ("b.json", ["--camera", "camera.json"])):
        assert main(["convert", str(ROOM), "-o", name, "--fast", "--quiet", *more]) == 0
        assert "camera " in capsys.readouterr().out
    first, second = (json.loads((folder / name).read_text()) for name in ("a.json", "b.json"))
    assert second["camera"]["K"] == first["camera"]["K"]
    turn = np.array(first["camera"]["R_cam_from_world"]).T @ second["camera"]["R_cam_from_world"]
    assert np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))) < 0.1
    assert set(first["certainty"]) == {"quality", "reason", "rotation_degrees", "focal", "principal_point", "k1"}


def test_camera_refuses_what_it_cannot_write_before_it_reads(fails):
    assert "a camera is written as" in fails("camera", "none.jpg", "-o", "a.step")
    assert "does not exist" in fails("camera", "none.jpg", "-o", "none/a.json")
    assert "named twice" in fails("camera", "none.jpg", "-o", "a.json", "-o", "a.json")
    assert "none.jpg" in fails("camera", "none.jpg", "-o", "a.json")


def test_camera_keeps_its_inputs(fails, folder):
    shutil.copy(ROOM, folder / "room.png")
    shutil.copy(SAMPLES / "room.json", folder)
    assert "is an input too" in fails("camera", "room.png", "-o", "room.png")
    assert "is an input too" in fails("camera", "room.png", "--camera", "room.json", "-o", "room.json")


def test_camera_takes_one_camera(fails):
    assert "not allowed with" in fails("camera", "a.jpg", "--camera", "a.json", "--focal", "900", code=2)


def test_camera_refuses_a_photo_without_lines(fails, folder):
    Image.new("RGB", (640, 480), "grey").save(folder / "grey.png")
    assert "0 straight segments found" in fails("camera", "grey.png", "-o", "a.json", "-o", "a.png")
