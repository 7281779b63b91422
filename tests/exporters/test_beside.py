import hashlib
import itertools
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from exporters.beside import NO_FILES, NOTHING, Beside, SideFiles, write_with_side_files
from linecad.errors import OutputError

REPOSITORY = Path(__file__).parents[2]
BESIDE = Beside(".textures", re.compile(r"photo-[0-9a-f]{16}\.jpg"), ".mtl")


def picture(content):
    """The name and the bytes of a picture that stands for a texture."""
    return f"photo-{hashlib.sha256(content).hexdigest()[:16]}.jpg", content


def version(number):
    """The pictures, the library and the text of one of the versions of a file; the text names what it needs."""
    pictures = dict([picture(b"%d of %d" % (each, number) * 1000) for each in range(3)])
    library = "".join(f"newmtl {name} a.obj.textures\n" for name in pictures)
    return pictures, library, "\n".join(pictures)


def put(path, number):
    pictures, library, text = version(number)

    def write(file):
        file.write_text(text)
        return SideFiles(pictures, library)

    write_with_side_files(path, BESIDE, write)


def put_alone(path):
    def write(file):
        file.write_text("alone")
        return NO_FILES

    write_with_side_files(path, BESIDE, write)


def check(path):
    """That the file is one of the versions and finds all that it names, each with its whole content; which one."""
    text = path.read_text()
    number = next(number for number in range(100) if version(number)[2] == text)
    names = BESIDE.names(path)
    library = path.with_name(names.library).read_text()
    for name in text.split():
        data = (path.with_name(names.folder) / name).read_bytes()
        assert name == picture(data)[0]
        assert f"newmtl {name}" in library
    return number


def everything(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_the_pictures_and_the_library_of_the_old_file_go(tmp_path):
    path = tmp_path / "a.obj"
    for number in (1, 2):
        put(path, number)
        pictures, library, text = version(number)
        assert path.read_text() == text
        assert (tmp_path / "a.obj.mtl").read_text() == library
        assert everything(tmp_path) == sorted(
            ["a.obj", "a.obj.mtl", "a.obj.textures", *(f"a.obj.textures/{name}" for name in pictures)]
        )


def test_a_file_without_pictures_leaves_none_of_the_old_ones(tmp_path):
    put(tmp_path / "a.obj", 1)
    put_alone(tmp_path / "a.obj")
    assert everything(tmp_path) == ["a.obj"]


def test_a_format_with_a_library_alone_needs_no_folder(tmp_path):
    path, beside = tmp_path / "a.csv", Beside(library=".planes.txt")

    def put(text):
        def write(file):
            file.write_text(text)
            return SideFiles({}, f"planes of {text}")

        write_with_side_files(path, beside, write)

    for text in ("one", "two"):
        put(text)
        assert path.read_text() == text
        assert (tmp_path / "a.csv.planes.txt").read_text() == f"planes of {text}"
    assert len(list(tmp_path.iterdir())) == 2


def test_what_is_not_ours_stays_in_the_folder(tmp_path):
    put(tmp_path / "a.obj", 1)
    (tmp_path / "a.obj.textures" / "mine.jpg").write_text("mine")
    put_alone(tmp_path / "a.obj")
    assert everything(tmp_path) == ["a.obj", "a.obj.textures", "a.obj.textures/mine.jpg"]


def test_files_of_other_names_keep_their_pictures(tmp_path):
    for name in ("a.obj", "a.usda", "a b.obj", "a_b.obj", "a'b.obj"):
        put(tmp_path / name, 1)
    put(tmp_path / "a.usda", 2)
    assert [check(tmp_path / name) for name in ("a.obj", "a.usda", "a b.obj", "a_b.obj", "a'b.obj")] == [1, 2, 1, 1, 1]


@pytest.mark.parametrize("before", [False, True])
def test_a_writer_that_fails_leaves_all_as_it_was(tmp_path, before):
    path = tmp_path / "a.obj"
    if before:
        put(path, 1)
    there = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}

    def fail(file):
        file.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="no space is left"):
        write_with_side_files(path, BESIDE, fail)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == there
    if not before:
        assert everything(tmp_path) == []


def test_a_picture_that_does_not_fit_on_the_disk_leaves_all_as_it_was(tmp_path):
    put(tmp_path / "a.obj", 1)
    script = (
        f"import resource, sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); from test_beside import *\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "pictures = {'photo-0123456789abcdef.jpg': bytes(10), 'photo-1123456789abcdef.jpg': bytes(5000)}\n"
        "def write(file): file.write_text('new'); return SideFiles(pictures, 'new')\n"
        "try: write_with_side_files(Path(sys.argv[1]), BESIDE, write)\n"
        "except Exception as error: print(error)"
    )
    command = [sys.executable, "-c", script, str(tmp_path / "a.obj")]
    output = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True).stdout
    assert "was not written" in output
    assert check(tmp_path / "a.obj") == 1
    assert len(everything(tmp_path)) == 6


def test_a_file_in_the_place_of_the_folder_is_named(tmp_path):
    (tmp_path / "a.obj.textures").write_text("in the way")
    with pytest.raises(OutputError, match=re.escape("a.obj.textures")):
        put(tmp_path / "a.obj", 1)
    assert everything(tmp_path) == ["a.obj.textures"]


def test_no_name_is_too_long_or_unfit_for_a_reader(tmp_path):
    for name in ("a" * 250 + ".obj", "家" * 80 + ".obj", 'Häuschen "家" it\'s.obj', os.fsdecode(b"\xff\xfe.obj")):
        folder, library = BESIDE.names(tmp_path / name)
        assert max(len(folder.encode()), len(library.encode())) <= 255
        assert re.fullmatch(r"[\w.-]+\.textures", folder)
        put(tmp_path / name, 1)
        assert check(tmp_path / name) == 1


def test_what_lies_beside_an_export_is_found_and_nothing_else(tmp_path):
    path = tmp_path / "a.obj"
    assert BESIDE.found(path) == []
    put(path, 1)
    put(tmp_path / "b.obj", 1)
    (tmp_path / "a.obj.textures" / "mine.jpg").write_text("mine")
    names = ["a.obj.mtl", *sorted(f"a.obj.textures/{name}" for name in version(1)[0])]
    assert [str(file.relative_to(tmp_path)) for file in BESIDE.found(path)] == names
    assert BESIDE.places(path) == [tmp_path / "a.obj.mtl", tmp_path / "a.obj.textures"]
    assert sorted(BESIDE.folders_in(tmp_path)) == [tmp_path / "a.obj.textures", tmp_path / "b.obj.textures"]
    assert NOTHING.found(path) == NOTHING.places(path) == NOTHING.folders_in(tmp_path) == []


@pytest.mark.parametrize(
    "name",
    [
        "a.obj",
        "a.obj.textures",
        "b.obj.mtl",
        "a.obj.mtl/photo-0123456789abcdef.jpg",
        "b.obj.textures/photo-0123456789abcdef.jpg",
        "a.obj.textures/photo-0123456789abcdef.jpg.sh",
        "a.obj.textures/deeper/photo-0123456789abcdef.jpg",
        "a.obj.textures/../photo-0123456789abcdef.jpg",
        "photo-0123456789abcdef.jpg",
    ],
)
def test_no_other_file_is_allowed_beside_an_export(tmp_path, name):
    path = tmp_path / "a.obj"
    assert BESIDE.allows(path, tmp_path / "a.obj.mtl")
    assert BESIDE.allows(path, tmp_path / "a.obj.textures" / "photo-0123456789abcdef.jpg")
    assert not BESIDE.allows(path, tmp_path / name)
    assert not NOTHING.allows(path, tmp_path / name)


@pytest.mark.parametrize("needed", [SideFiles({"other.jpg": b""}), SideFiles({}, "library")])
def test_what_the_row_of_a_format_does_not_name_is_our_own_mistake(tmp_path, needed):
    row = Beside(".textures", BESIDE.part)
    with pytest.raises(AssertionError, match="row"):
        write_with_side_files(tmp_path / "a.usda", row, lambda _: needed)
    assert everything(tmp_path) == []


def run_alone(work, folder):
    """Call a function of this module in a process without threads, which may fork, and which waits for no disk."""
    script = f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import test_beside\n"
    script += "test_beside.os.fsync = lambda _: None\n"  # for power cuts; what dies here is the process alone
    script += f"test_beside.{work.__name__}(test_beside.Path(sys.argv[1]))"
    command = [sys.executable, "-c", script, str(folder)]
    result = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=False, timeout=120)
    assert result.returncode == 0, result.stderr


def fork(work):
    """The id of a child that calls `work` and ends."""
    child = os.fork()
    if not child:
        try:
            work()
            os._exit(0)
        finally:
            os._exit(1)
    return child


def dying(real, left):
    """A function that ends the process as kill -9 does, before or after what it does, when its turn comes."""

    def change(*given, **named):
        for moment in (lambda: None, lambda: real(*given, **named)):
            result = moment()
            left[0] -= 1
            if left[0] == 0:
                os._exit(9)
        return result

    return change


def die(path, moment, number):
    left = [moment]
    for name in ("replace", "unlink", "mkdir", "rmdir", "chmod", "write_bytes", "write_text"):
        setattr(Path, name, dying(getattr(Path, name), left))
    put(path, number)


def end_at_every_moment(folder):
    found, code, moment = set(), 9, 0
    while code == 9:
        moment += 1
        path = folder / str(moment) / "a.obj"
        path.parent.mkdir()
        put(path, 1)
        _, status = os.waitpid(fork(lambda path=path, moment=moment: die(path, moment, 2)), 0)
        code = os.waitstatus_to_exitcode(status)
        found.add(check(path))
        put(path, 3)  # the next export leaves nothing over but hidden files that were begun
        assert check(path) == 3
        assert len([name for name in everything(path.parent) if ".linecad-" not in name]) == 6
    assert code == 0
    assert moment > 30
    assert found == {1, 2}


def test_an_end_at_any_moment_leaves_the_old_file_or_the_new_one_and_all_that_it_needs(tmp_path):
    run_alone(end_at_every_moment, tmp_path)


def kill_at_forty_moments(folder):
    path, chance, found = folder / "a.obj", random.Random(1), []
    put(path, 0)
    began = time.perf_counter()
    for number in range(10):
        put(path, number)
    longest = 2 * (time.perf_counter() - began)
    for number in range(1, 41):
        child = fork(lambda number=number: [put(path, each) for each in itertools.islice(itertools.count(number), 60)])
        time.sleep(chance.uniform(0.0, longest))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        found.append(check(path))
    assert len(set(found)) > 1


def test_kill_at_any_moment_leaves_a_whole_file(tmp_path):
    run_alone(kill_at_forty_moments, tmp_path)


def three_at_once(folder):
    path = folder / "a.obj"
    children = [
        fork(lambda number=number: [put(path, number + each % 2) for each in range(1, 10)]) for number in (1, 2, 3)
    ]
    assert [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children] == [0, 0, 0]
    assert check(path) in {1, 2, 3, 4}
    assert len(everything(folder)) == 6


def test_several_at_once_to_one_name_leave_one_whole_file(tmp_path):
    run_alone(three_at_once, tmp_path)
