import errno
import os
import stat
import tempfile
import threading
from pathlib import Path

import pytest

from linecad.errors import OutputError
from linecad.io.files import UNFINISHED, check_output, remove_unfinished, write_atomically


def writing(text):
    return lambda path: path.write_text(text)


def failing(error):
    def write(path):
        path.write_text("half of it")
        raise error

    return write


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_the_file_holds_what_the_writer_wrote(tmp_path):
    write_atomically(tmp_path / "a.txt", writing("whole"))
    assert (tmp_path / "a.txt").read_text() == "whole"
    assert names(tmp_path) == ["a.txt"]


def test_what_killed_writers_left_is_removed_and_nothing_else(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "a.txt").write_text("mine")
    (tmp_path / f"{UNFINISHED}1.txt").write_text("half")
    (tmp_path / f"{UNFINISHED}2").mkdir()
    (tmp_path / f"{UNFINISHED}2" / "a.txt").write_text("half")
    (tmp_path / f"{UNFINISHED}3").symlink_to(tmp_path / "elsewhere")
    remove_unfinished(tmp_path)
    assert names(tmp_path) == ["elsewhere"]
    assert (tmp_path / "elsewhere" / "a.txt").read_text() == "mine"


def test_the_writer_gets_a_hidden_name_with_the_suffix_in_lower_case(tmp_path):
    seen = []

    def write(path):
        seen.append(path)
        path.write_text("")

    write_atomically(tmp_path / "Secret.STEP", write)
    assert seen[0].parent == tmp_path
    assert seen[0].name.startswith(".")
    assert seen[0].suffix == ".step"
    assert "Secret" not in seen[0].name


@pytest.mark.parametrize("error", [OSError(errno.EIO, "broken"), OutputError("too much"), KeyboardInterrupt()])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path, error):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises((OutputError, KeyboardInterrupt)):
        write_atomically(tmp_path / "a.txt", failing(error))
    assert (tmp_path / "a.txt").read_text() == "old"
    assert names(tmp_path) == ["a.txt"]


@pytest.mark.parametrize(
    ("number", "words"),
    [(errno.ENOSPC, "no space is left"), (errno.EROFS, "not allowed"), (errno.EIO, "Input/output error")],
)
def test_a_failure_of_the_disk_is_told_in_one_line(tmp_path, number, words):
    with pytest.raises(OutputError, match=words) as caught:
        write_atomically(tmp_path / "a.txt", failing(OSError(number, os.strerror(number))))
    assert "a.txt" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_disk_that_is_full_only_when_flushed_counts_as_a_failure(tmp_path, monkeypatch):
    def fsync(_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(OutputError, match="no space"):
        write_atomically(tmp_path / "a.txt", writing("whole"))
    assert names(tmp_path) == []


def test_an_old_file_keeps_its_mode(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    path.chmod(0o640)
    write_atomically(path, writing("new"))
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


def test_a_new_file_has_the_mode_that_the_umask_asks_for(tmp_path):
    before = os.umask(0o027)
    try:
        write_atomically(tmp_path / "a.txt", writing("new"))
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a.txt").stat().st_mode) == 0o640


def test_a_symbolic_link_stays_one(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "link.txt").symlink_to(tmp_path / "folder" / "real.txt")
    write_atomically(tmp_path / "link.txt", writing("new"))
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "folder" / "real.txt").read_text() == "new"


def test_two_writers_at_once_leave_one_whole_file(tmp_path):
    texts = ["a" * 100_000, "b" * 100_000]
    both = threading.Barrier(2)

    def write(text):
        def writer(path):
            with path.open("w") as file:
                file.write(text[:50_000])
                file.flush()
                both.wait(10)  # now both have written one half
                file.write(text[50_000:])

        write_atomically(tmp_path / "a.txt", writer)

    threads = [threading.Thread(target=write, args=[text]) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (tmp_path / "a.txt").read_text() in texts
    assert names(tmp_path) == ["a.txt"]


def test_a_missing_folder_is_to_be_made_first(tmp_path):
    with pytest.raises(OutputError, match="does not exist; make it first"):
        check_output(tmp_path / "no" / "a.txt")
    assert names(tmp_path) == []


def test_a_folder_is_no_output(tmp_path):
    (tmp_path / "a.step").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        check_output(tmp_path / "a.step")


def test_a_file_in_the_place_of_the_folder_is_named(tmp_path):
    (tmp_path / "a").write_text("")
    with pytest.raises(OutputError, match="make it first"):
        check_output(tmp_path / "a" / "b.step")


def test_a_pipe_is_no_output(tmp_path):
    os.mkfifo(tmp_path / "a.step")
    with pytest.raises(OutputError, match="not a regular file"):
        check_output(tmp_path / "a.step")


@pytest.mark.parametrize("name", ["x" * 300 + ".step", "a\0b.step"])
def test_a_name_that_no_file_can_have(tmp_path, name):
    with pytest.raises(OutputError, match="cannot be used as a file name"):
        check_output(tmp_path / name)


def test_the_longest_name_is_written(tmp_path):
    name = "x" * 250 + ".step"
    write_atomically(tmp_path / name, writing("whole"))
    assert names(tmp_path) == [name]


@pytest.fixture
def as_nobody():
    """A folder of its own outside of pytest's, which only its owner may enter; the superuser becomes nobody."""
    nobody = 65534
    superuser = os.geteuid() == 0
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        inner = Path(folder) / "inner"
        inner.mkdir()
        if superuser:
            os.chown(inner, nobody, nobody)
            os.seteuid(nobody)
        try:
            yield inner
        finally:
            if superuser:
                os.seteuid(0)
            inner.chmod(0o755)


def test_a_folder_that_cannot_be_written(as_nobody):
    as_nobody.chmod(0o555)
    with pytest.raises(OutputError, match="cannot be written; choose another one"):
        check_output(as_nobody / "a.step")
    with pytest.raises(OutputError, match="cannot be written"):
        write_atomically(as_nobody / "a.step", writing(""))


def test_a_write_protected_file_stays(as_nobody):
    (as_nobody / "a.step").write_text("old")
    (as_nobody / "a.step").chmod(0o444)
    with pytest.raises(OutputError, match="write-protected"):
        write_atomically(as_nobody / "a.step", writing("new"))
    assert (as_nobody / "a.step").read_text() == "old"
