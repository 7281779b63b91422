"""Processes of one thread, and how many threads others have."""

import multiprocessing
import os
import subprocess
import sys

import cv2
import pytest

from linecad.threads import ONE_THREAD, THREADS, start_with_one_thread, thread_count

# In a process of its own: a test must not change how its own process computes.
REPORT = """
import cv2
from linecad.threads import compute_with_one_thread
before = cv2.getNumThreads()
compute_with_one_thread()
print(before, cv2.getNumThreads(), cv2.ocl.useOpenCL())
"""


@pytest.mark.parametrize(("asked", "expected"), [("3", 3), ("0", 1), ("many", os.cpu_count()), (None, os.cpu_count())])
def test_the_number_of_threads_is_what_the_environment_asks_for(monkeypatch, asked, expected):
    if asked is None:
        monkeypatch.delenv(THREADS[0], raising=False)
    else:
        monkeypatch.setenv(THREADS[0], asked)
    assert thread_count() == expected


def environment():
    return {name: os.environ.get(name) for name in THREADS}


def test_processes_start_with_one_thread_and_this_one_keeps_its_environment(monkeypatch):
    monkeypatch.setenv(THREADS[0], "7")
    monkeypatch.delenv(THREADS[1], raising=False)
    before = environment()
    with start_with_one_thread(), multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(environment) == ONE_THREAD
    assert environment() == before


def test_the_environment_is_kept_through_an_error():
    before = environment()
    with pytest.raises(KeyboardInterrupt), start_with_one_thread():
        raise KeyboardInterrupt
    assert environment() == before


def test_opencv_computes_with_one_thread_too():
    ended = subprocess.run([sys.executable, "-c", REPORT], capture_output=True, text=True, check=True)
    before, after, uses_opencl = ended.stdout.split()
    assert int(before) == cv2.getNumThreads()
    assert (after, uses_opencl) == ("1", "False")
