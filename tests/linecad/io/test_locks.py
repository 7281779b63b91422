"""Locks: one process at a time, free as soon as it ends, and no file left."""

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from linecad.errors import LinecadError
from linecad.io.locks import acquire, alone, waiting_for

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no such locks there")
WORDS = ("another one works here", "wait for it")
HOLD = "import sys; from pathlib import Path; from linecad.io.locks import acquire; acquire(Path(sys.argv[1]), '', '')"


def test_the_second_is_refused_in_one_line_that_names_the_first(tmp_path):
    path = tmp_path / "lock"
    with alone(path, *WORDS):
        with pytest.raises(LinecadError) as refused, alone(path, *WORDS):
            pass
        assert str(refused.value) == f"another one works here (process {os.getpid()}); wait for it"
        assert path.exists()


def test_afterwards_nothing_is_left_and_the_next_may_begin(tmp_path):
    for _ in range(2):
        with alone(tmp_path / "lock", *WORDS):
            assert (tmp_path / "lock").read_text() == f"{os.getpid()}\n"
        assert list(tmp_path.iterdir()) == []


def test_a_process_that_was_killed_keeps_nobody_out(tmp_path):
    path = tmp_path / "lock"
    command = [sys.executable, "-c", HOLD + "; print('held', flush=True); sys.stdin.read()", str(path)]
    root = Path(__file__).resolve().parents[3]
    with subprocess.Popen(command, cwd=root, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(LinecadError, match=f"process {holder.pid}"), alone(path, *WORDS):
            pass
        holder.kill()
    assert path.exists()
    with alone(path, *WORDS):
        pass
    assert not path.exists()


def test_who_waits_while_the_file_is_removed_holds_the_one_that_is_there_then(tmp_path):
    """A lock on a file without a name would keep nobody out."""
    path = tmp_path / "lock"
    first = acquire(path, *WORDS)
    held = []
    waiting = threading.Thread(target=lambda: held.append(acquire(path, *WORDS, patience=100.0)))
    waiting.start()
    time.sleep(0.1)  # it has the old file open, most likely
    path.unlink()
    os.close(first)
    waiting.join()
    assert os.path.samestat(os.fstat(held[0]), path.stat())
    os.close(held[0])


def test_a_folder_is_waited_for_and_no_file_is_left(tmp_path):
    entered = threading.Event()

    def enter():
        with waiting_for(tmp_path) as locked:
            assert locked
            entered.set()

    other = threading.Thread(target=enter)
    with waiting_for(tmp_path) as locked:
        assert locked
        other.start()
        assert not entered.wait(0.2)
    other.join(60)
    assert entered.is_set()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_locked_is_told_so(tmp_path):
    with waiting_for(tmp_path / "none") as locked:
        assert not locked


def test_where_no_lock_can_be_had_nobody_is_kept_out(tmp_path):
    entered = False
    with alone(tmp_path / "no such folder" / "lock", *WORDS):
        entered = True
    assert entered
