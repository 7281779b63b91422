"""One batch a folder."""

import os
import subprocess
import sys
import time

import pytest

from linecad.batch.lock import NAME, locked
from linecad.errors import LinecadError, OutputError


def test_a_second_batch_is_refused_and_named(tmp_path):
    with locked(tmp_path), pytest.raises(LinecadError, match=f"process {os.getpid()}"), locked(tmp_path, patience=0):
        pass


def test_the_lock_is_free_when_the_batch_is_over(tmp_path):
    for _ in range(2):
        with locked(tmp_path, patience=0) as descriptor:
            assert os.pread(descriptor, 32, 0).decode().strip() == str(os.getpid())


def test_a_process_that_inherited_the_lock_holds_it_until_it_ends(tmp_path):
    with locked(tmp_path) as descriptor:
        waiting = "import sys; sys.stdin.read()"
        orphan = subprocess.Popen([sys.executable, "-c", waiting], stdin=subprocess.PIPE, pass_fds=(descriptor,))
    with orphan:
        with pytest.raises(LinecadError, match="another batch works"), locked(tmp_path, patience=0.2):
            pass
        orphan.kill()
        began = time.monotonic()
        with locked(tmp_path, patience=100):  # as soon as it is gone
            assert time.monotonic() - began < 50


def test_a_lock_that_is_a_link_is_not_followed(tmp_path):
    (tmp_path / NAME).symlink_to(tmp_path / "elsewhere")
    with pytest.raises(OutputError, match="choose another folder"), locked(tmp_path):
        pass
    assert not (tmp_path / "elsewhere").exists()
