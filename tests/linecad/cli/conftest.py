"""A working folder, a command that must fail in one line, and a scene file."""

import zlib
from pathlib import Path

import pytest

import linecad.pipeline
from linecad.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "samples"
ROOM = SAMPLES / "room.jpg"


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


@pytest.fixture(scope="session", autouse=True)
def reconstructed_once():
    """One photo with one camera and the same options is reconstructed once for all tests: it takes longer than they do.

    With corrections or a depth map it is done each time, and so it is where a test replaces the placement of bodies,
    also one of another folder that runs later in this process.
    """
    reconstruct, known = linecad.pipeline.reconstruct, {}

    def remember(photo, options, on_progress=None, on_stage=lambda _: None, *more):
        if any(each is not None for each in more):
            return reconstruct(photo, options, on_progress, on_stage, *more)
        key = (zlib.crc32(photo.pixels), repr(photo), options, linecad.pipeline.find_evidence)
        if key not in known:
            known[key] = reconstruct(photo, options, on_progress, on_stage)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(linecad.pipeline, "reconstruct", remember)
        yield


@pytest.fixture(scope="session")
def scene_file(tmp_path_factory):
    """The scene of a sample photo."""
    path = tmp_path_factory.mktemp("scene") / "room.json"
    assert main(["convert", str(ROOM), "-o", str(path), "--fast", "--option", "largest-component=on", "--quiet"]) == 0
    return path
