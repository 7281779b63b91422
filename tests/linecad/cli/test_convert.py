"""`linecad convert`: what it refuses, in one line, and what it never leaves behind."""

import io
import json
import os
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import threading
import zlib
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

import linecad.pipeline
from linecad.cli.main import main
from linecad.corrections.edits import Corrections
from linecad.corrections.file import write_corrections
from linecad.errors import OutputError, ReconstructionError
from linecad.io.scene_file import read_scene, write_scene
from linecad.options import Options
from solver.options import SolveOptions

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
ROOM = SAMPLES / "room.jpg"
posix = pytest.mark.skipif(os.name == "nt", reason="signals, links and limits as on POSIX")


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
@pytest.mark.thorough
def test_ctrl_c_keeps_the_best_answer_and_writes_the_files(folder):
    street = [SAMPLES / "street.jpg", "--camera", SAMPLES / "street.json", "--option", "extension=90",
              "--option", "formulation=gain"]  # fmt: skip
    code, out, _ = interrupt(["convert", *street, "-o", "a.json", "-o", "a.obj"], folder, "Ctrl-C keeps the best")
    assert code == 0
    scene = json.loads((folder / "a.json").read_text())
    assert scene["solve"]["status"] == "interrupted"
    assert any("was interrupted" in note for note in scene["notes"])
    assert len(scene["lines"]) > 100
    assert "program: interrupted, gap " in out
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


def test_the_summary_tells_the_status_as_the_programs(folder, capsys):
    assert main(["convert", str(ROOM), "-o", "a.json", "--fast", "--quiet"]) == 0
    out = capsys.readouterr().out.splitlines()
    scene = read_scene(folder / "a.json")
    real = int(scene.intersections.real.sum())
    counts = (
        f"{len(scene.lines)} lines, {real} of {len(scene.intersections)} crossings real, {len(scene.planes)} planes"
    )
    assert out[0] == f"{counts}; program: robust fit, gap unknown"
    assert out[1].startswith("camera ")
    assert out[2:] == [f"note: {note}" for note in scene.notes]


def test_corrections_of_another_photo_are_refused(fails, folder):
    write_corrections(Corrections("room.jpg", 400, 300), folder / "said.json")
    assert "said.json" in fails("convert", ROOM, "-o", "a.json", "--corrections", "said.json")


def test_a_confidence_filters_every_file_and_the_summary(folder, monkeypatch, capsys):
    reconstruct = linecad.pipeline.reconstruct
    made = []

    def told(photo, _options, *given):  # by the fast program, which tells no probabilities itself
        scene = reconstruct(photo, Options(solve=SolveOptions(fast=True)), *given)
        probability = np.linspace(0, 1, len(scene.lines))
        made.append(replace(scene, lines=replace(scene.lines, probability=probability)))
        return made[0]

    monkeypatch.setattr(linecad.pipeline, "reconstruct", told)
    arguments = ["-o", "a.json", "-o", "a.dxf", "--confidence", "0.8", "--quiet"]
    assert main(["convert", str(ROOM), *arguments]) == 0
    scene = read_scene(folder / "a.json")
    kept = made[0].lines.id[made[0].lines.probability >= 0.8].tolist()
    assert scene.lines.id.tolist() == kept
    assert (folder / "a.dxf").read_text().count("\nAcDbLine\n") == len(kept)
    out = capsys.readouterr().out
    assert out.startswith(f"{len(kept)} lines, ")
    assert out.endswith("the probability that their depth is right is below 0.8\n")


def test_a_bad_confidence_is_refused_before_the_photo_is_looked_for(fails):
    assert "'2' is not a number from 0 to 1" in fails(
        "convert", "none.jpg", "-o", "a.json", "--confidence", "2", code=2
    )
    assert "'x' is not a number from 0 to 1" in fails("batch", "none.jpg", "-o", "out", "--confidence", "x", code=2)


@pytest.mark.parametrize("command", [["convert", "none.jpg", "-o", "a.json"], ["batch", "none.jpg", "-o", "out"]])
def test_what_no_scene_can_serve_is_refused_before_the_photo_is_looked_for(fails, folder, command):
    assert "only formulation=bodies tells how likely" in fails(*command, "--fast", "--confidence", "0.5")
    drawn = ["--format", "elevation.pdf"] if command[0] == "batch" else ["-o", "a.elevation.pdf"]
    assert "drawing-scale=1:50 needs a known length" in fails(*command, *drawn, "--option", "drawing-scale=1:50")
    assert list(folder.glob("a.*")) + list(folder.glob("out*")) == []


class Loader:
    """What a pickle would run."""

    def __reduce__(self):
        return (Path("ran").touch, ())


def npz_of(array):
    stream = io.BytesIO()
    np.savez_compressed(stream, depth=array)
    return stream.getvalue()


def npy_of(array):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


DEPTHS = np.random.default_rng(0).uniform(1, 9, (60, 90)).astype(np.float32)
BAD_MAPS = {
    "missing": (lambda: None, "does not exist"),
    "empty": (lambda: b"", "is empty"),
    "text": (lambda: b"no depth, just words", "is not a depth map that linecad can read"),
    "truncated": (lambda: npz_of(DEPTHS)[:5000], "is damaged or incomplete"),
    "pickled": (lambda: npy_of(np.array([[Loader()] * 20] * 20, object)), "map.npz"),
    "on its side": (lambda: npz_of(DEPTHS.reshape(90, 60)), "lies on its side"),
}


@pytest.mark.parametrize("name", BAD_MAPS)
def test_files_that_are_no_depth_map(fails, folder, name):
    content, words = BAD_MAPS[name]
    if content() is not None:
        (folder / "map.npz").write_bytes(content())
    said = fails("convert", ROOM, "--depth", "map.npz", "-o", "a.json", "-o", "a.step")
    assert "map.npz" in said
    assert words in said
    assert not (folder / "ran").exists()


def test_the_map_itself_is_not_overwritten(fails, folder):
    (folder / "map.png").write_bytes(b"1")
    assert "is an input too" in fails("convert", ROOM, "--depth", "map.png", "-o", "map.png")


def test_a_map_reaches_the_program(fails, folder, monkeypatch):
    np.savez(folder / "map.npz", depth=DEPTHS)

    def look(_graph, sight, *_):
        raise ReconstructionError(f"seen {sight.depth.values.shape} {sight.depth.kind} {sight.depth.values.max()}")

    monkeypatch.setattr(linecad.pipeline, "find_evidence", look)
    arguments = ["convert", ROOM, "--depth", "map.npz", "--option", "depth-kind=distance", "-o", "a.json"]
    assert f"seen (1067, 1600) distance {DEPTHS.max()}" in fails(*arguments)


def test_detail_filters_every_file_and_the_summary(folder, capsys):
    assert main(["convert", str(ROOM), "-o", "a.json", "--fast", "--quiet"]) == 0
    outlines = [line for line in read_scene(folder / "a.json").lines.role.tolist() if line == "outline"]
    capsys.readouterr()
    assert main(["convert", str(ROOM), "-o", "b.json", "--fast", "--detail", "none", "--quiet"]) == 0
    assert read_scene(folder / "b.json").lines.role.tolist() == outlines != []
    assert capsys.readouterr().out.startswith(f"{len(outlines)} lines, ")


def failing(capsys, *arguments):
    """The one line that a conversion of the room ends with."""
    assert main(["convert", str(ROOM), "--fast", "--quiet", *arguments]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1, err
    return err.strip()


def command_in(line):
    return shlex.split(line.partition("go on with: linecad ")[2])


def test_a_length_that_is_not_there_costs_no_second_solving(folder, capsys):
    """The first command of each guide ended after all the work with nothing written."""
    outputs = ["-o", "room.dxf", "-o", "room.json"]
    said = failing(capsys, "--scale", "99999=3.5", *outputs, "--option", "roles=on")
    assert "no line 99999" in said
    assert [path.name for path in folder.iterdir()] == ["room.json"]
    words = command_in(said)
    assert words == ["export", "room.json", "--photo", str(ROOM), "--scale", "U,V:U2,V2=METRES", "--option", "roles=on",
                     *outputs]  # fmt: skip
    lines = json.loads(Path("room.json").read_text())["lines"]
    (u, v), (x, y) = next(line["segment"] for line in lines if line["component"] == 0)
    words[words.index("U,V:U2,V2=METRES")] = f"{u},{v}:{x},{y}=3.5"
    assert main([*words, "--quiet"]) == 0
    assert json.loads(Path("room.json").read_text())["metres_per_unit"] > 0
    assert Path("room.dxf").exists()


def test_a_scene_that_nobody_asked_for_is_kept_under_a_free_name(folder, capsys):
    (folder / "room.json").write_text("something else")
    said = failing(capsys, "--scale", "99999=3.5", "--detail", "none", "-o", "room.dxf")
    assert sorted(path.name for path in folder.iterdir()) == ["room.2.json", "room.json"]
    assert (folder / "room.json").read_text() == "something else"
    assert command_in(said)[1] == "room.2.json"
    assert command_in(said)[-4:] == ["--detail", "none", "-o", "room.dxf"]


def test_an_output_that_cannot_be_written_leaves_the_others(folder, capsys, monkeypatch):
    def refuse(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("exporters.mesh.write", refuse)
    said = failing(capsys, "-o", "a.stl", "-o", "a.dxf", "-o", "a.ply")
    assert said.startswith("linecad: a.stl was not written: no space is left for it")
    assert "(1 more were not written)" in said
    assert sorted(path.name for path in folder.iterdir()) == ["a.dxf", "a.json"]
    assert command_in(said) == ["export", "a.json", "--photo", str(ROOM), "-o", "a.stl", "-o", "a.ply"]
    monkeypatch.undo()
    os.chdir(folder)
    assert main([*command_in(said), "--quiet"]) == 0


def test_a_scene_is_kept_beside_another_output_where_its_own_folder_takes_no_file(folder, capsys, monkeypatch):
    """A folder that was there at the start, and took no file when the photo was solved, cost the whole solving."""

    def refuse(scene, path):
        if path.parent.name == "locked":
            raise OutputError(f"{path} was not written: writing there is not allowed; choose another folder")
        write_scene(scene, path)

    for name in ("locked", "ok"):
        (folder / name).mkdir()
    outputs = ["-o", "locked/room.json", "-o", "ok/facade.dxf"]
    monkeypatch.setattr("linecad.outputs.write_scene", refuse)
    said = failing(capsys, *outputs)
    assert said.startswith("linecad: locked/room.json was not written: writing there is not allowed")
    assert "; the scene is kept in ok/facade.json, go on with: " in said
    assert command_in(said) == ["export", "ok/facade.json", "--photo", str(ROOM), *outputs[:2]]
    assert sorted(path.name for path in folder.rglob("*.*")) == ["facade.dxf", "facade.json"]
    monkeypatch.setattr("linecad.outputs.write_scene", write_scene)
    assert main([*command_in(said), "--quiet"]) == 0
    assert Path("locked/room.json").read_bytes() == Path("ok/facade.json").read_bytes()


def test_a_scene_that_cannot_be_kept_either_is_said(folder, capsys, monkeypatch):
    def refuse(*_):
        raise OutputError("room.json was not written: no space is left for it; free some or choose another disk")

    monkeypatch.setattr("linecad.outputs.write_scene", refuse)
    said = failing(capsys, "--scale", "99999=3.5", "-o", "room.json")
    assert "no line 99999" in said
    assert said.endswith("the scene was not kept either: " + "room.json was not written: no space is left for it; "
                         "free some or choose another disk")  # fmt: skip
    assert list(folder.iterdir()) == []


@pytest.mark.usefixtures("folder")
def test_groups_and_the_main_one(capsys):
    """A place on another group makes it component 0, and that alone is written."""
    made = ["convert", str(ROOM), "--quiet"]
    assert main([*made, "-o", "a.json"]) == 0
    whole = read_scene("a.json").lines
    assert whole.component.max() > 0
    u, v = whole.segment[whole.component == 1][0].mean(axis=0)
    assert main([*made, "--groups", "main", "-o", "b.json"]) == 0
    assert read_scene("b.json").lines.id.tolist() == whole.id[whole.component == 0].tolist()
    assert main(["export", "a.json", "--main", f"{u},{v}", "--groups", "main", "-o", "c.json", "--quiet"]) == 0
    assert read_scene("c.json").lines.id.tolist() == whole.id[whole.component == 1].tolist()
    assert main([*made, "--main", f"{u},{v}", "-o", "d.json"]) == 0
    assert (read_scene("d.json").lines.component == 0).tolist() == (whole.component == 1).tolist()
    capsys.readouterr()
    said = failing(capsys, "--main", "1e6,1e6", "-o", "e.json")
    assert "no line and no face stands at 1e+06,1e+06 px" in said
    assert command_in(said) == ["export", "e.json", "--photo", str(ROOM), "--main", "U,V", "-o", "e.json"]
