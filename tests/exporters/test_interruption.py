"""Exports that are killed, and exports by several processes at once, leave one whole file.

One process loads the libraries and forks the exports, so that thirty of them cost no more than their writing.
"""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from linecad.io.scene_file import write_scene

pytestmark = pytest.mark.skipif(os.name == "nt", reason="forks and signals as on POSIX")

REPOSITORY = Path(__file__).parents[2]
SUFFIXES = [
    ".dxf",
    *(pytest.param(suffix, marks=pytest.mark.thorough) for suffix in (".step", ".glb", ".usda", ".usdz", ".obj")),
]

COMMON = """
import json, os, signal, sys, time
from pathlib import Path
from exporters.formats import export
from linecad.io.scene_file import read_scene
scenes = [read_scene(Path(sys.argv[1]) / name) for name in ("old.json", "new.json")]
folder, suffix = Path(sys.argv[2]), sys.argv[3]
path = folder / ("a" + suffix)
whole = []
for scene in scenes:
    export(scene, path)
    whole.append(path.read_bytes())
assert whole[0] != whole[1]

def found():
    data = path.read_bytes()
    return ["old", "new"][whole.index(data)] if data in whole else "broken"

def begin(scene, prepare=lambda: None):
    child = os.fork()
    if child == 0:
        prepare()
        export(scene, path)
        os._exit(0)
    return child
"""

# Killed at every call by which an export changes what is on the disk, just before it is made.
AT_EVERY_CALL = (
    COMMON
    + """
CALLS = {"open", "os.rename", "os.remove", "os.chmod", "os.mkdir", "os.rmdir"}

def kill_at(number):
    def prepare():
        left = [number]
        def hook(event, arguments):
            if event in CALLS and not (event == "open" and str(arguments[0]).startswith("/proc")):
                left[0] -= 1
                if left[0] < 0:
                    os.kill(os.getpid(), signal.SIGKILL)
        sys.addaudithook(hook)
    return prepare

outcomes = []
for number in range(60):
    path.write_bytes(whole[0])
    _, status = os.waitpid(begin(scenes[1], kill_at(number)), 0)
    outcomes.append([os.WIFSIGNALED(status), found()])
    if not os.WIFSIGNALED(status):
        break
print(json.dumps(outcomes))
"""
)

# Killed at moments spread over the time that an export takes, wherever it then is, also inside a library.
AT_MOMENTS = (
    COMMON
    + """
started = time.perf_counter()
os.waitpid(begin(scenes[1]), 0)
duration = time.perf_counter() - started
outcomes = []
for number in range(8):
    path.write_bytes(whole[0])
    child = begin(scenes[1])
    time.sleep(duration * (0.15 + 0.85 * number / 7))
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if not os.WIFSIGNALED(status):
        duration /= 2  # the machine was busier when it was measured
    outcomes.append([os.WIFSIGNALED(status), found()])
print(json.dumps(outcomes))
"""
)

AT_ONCE = (
    COMMON
    + """
outcomes = []
for number in range(6):
    children = [begin(scene) for scene in scenes + scenes]
    codes = [os.waitpid(child, 0)[1] for child in children]
    outcomes.append([any(codes), found()])
print(json.dumps(outcomes))
"""
)


@pytest.fixture(scope="module")
def scenes(scene, tmp_path_factory):
    """A folder with two scenes that give different files."""
    folder = tmp_path_factory.mktemp("scenes")
    write_scene(scene, folder / "new.json")
    write_scene(replace(scene, metres_per_unit=0.5), folder / "old.json")
    return folder


def run(script, *arguments):
    command = [sys.executable, "-c", script, *map(str, arguments)]
    ended = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, timeout=120, check=False)
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


@pytest.mark.parametrize("suffix", [".dxf", pytest.param(".usdz", marks=pytest.mark.thorough)])
def test_killed_at_any_call_it_leaves_the_old_file_or_the_new_one(scenes, tmp_path, suffix):
    outcomes = run(AT_EVERY_CALL, scenes, tmp_path, suffix)
    assert outcomes[-1] == [False, "new"]  # the last one ran to its end, so every call had its turn
    assert {found for _, found in outcomes} == {"old", "new"}
    assert len(outcomes) >= 6
    order = [found for _, found in outcomes]
    assert order == sorted(order, reverse=True)  # old, until it is put in its place in one step


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_killed_at_any_moment_it_leaves_the_old_file_or_the_new_one(scenes, tmp_path, suffix):
    """Eight moments each of six formats: 48 kills."""
    outcomes = run(AT_MOMENTS, scenes, tmp_path, suffix)
    assert {found for _, found in outcomes} <= {"old", "new"}
    assert sum(killed for killed, _ in outcomes) >= 2  # the others had ended before


@pytest.mark.parametrize(
    "suffix", [".dxf", *(pytest.param(suffix, marks=pytest.mark.thorough) for suffix in (".step", ".usdc"))]
)
def test_four_processes_at_once_leave_one_whole_file_and_nothing_else(scenes, tmp_path, suffix):
    outcomes = run(AT_ONCE, scenes, tmp_path, suffix)
    assert {failed for failed, _ in outcomes} == {False}
    assert {found for _, found in outcomes} <= {"old", "new"}
    assert [path.name for path in tmp_path.iterdir()] == [f"a{suffix}"]
