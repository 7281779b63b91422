"""What all tests share: two tiers, the photographs for measuring, permissions that bind root too, no skips in CI."""

import ctypes
import importlib
import os
import signal
import sys
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

NO_SKIPS = "LINECAD_NO_SKIPS"  # 1 where everything that a test may need is there, so that a skip is a failure
DATA = "LINECAD_DATA"  # the folder with the photographs for measuring, which are no part of the project

# How long an example takes says how busy the machine is. A test that needs more examples than these says so itself.
settings.register_profile("thorough", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("everyday", settings.get_profile("thorough"), max_examples=25)

# A shell starts what it runs in the background with SIGINT ignored, and every child inherits that: no Ctrl-C that a
# test sends would arrive.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--thorough", action="store_true", help="run the tests marked thorough too, with more examples")


def pytest_configure(config: pytest.Config) -> None:
    settings.load_profile("thorough" if config.getoption("thorough") else "everyday")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Without --thorough, the tests that are marked so are left out: they are not skipped, which CI would refuse."""
    if config.getoption("thorough"):
        return
    left_out = [item for item in items if item.get_closest_marker("thorough")]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("thorough")]


@pytest.fixture(scope="session")
def thorough(request: pytest.FixtureRequest) -> bool:
    """Whether this is the thorough run, for tests that take more of the same there."""
    return bool(request.config.getoption("thorough"))


Report = TypeVar("Report", pytest.TestReport, pytest.CollectReport)


def refuse_skip(report: Report) -> Report:
    """The report, turned into a failure when it is a skip and no skip is allowed."""
    if os.environ.get(NO_SKIPS) == "1" and report.skipped and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"{report.nodeid}: {reason} ({NO_SKIPS}=1 allows no skip)"
    return report


class NoPhotographs(pytest.skip.Exception):
    """A skip that is allowed everywhere: nobody said where the photographs are, and no clone has them."""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    call: pytest.CallInfo[None],
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    without_photographs = call.excinfo is not None and isinstance(call.excinfo.value, NoPhotographs)
    return report if without_photographs else refuse_skip(report)


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    return refuse_skip((yield))


@pytest.fixture(scope="session")
def photographs() -> Path:
    """The folder with the photographs for measuring (castle, york_urban, ...)."""
    name = os.environ.get(DATA)
    if not name:
        raise NoPhotographs(f"needs photographs for measuring; name their folder in {DATA}")
    folder = Path(name)
    if not folder.is_dir():
        pytest.fail(f"{DATA} is {name}, which is not a folder")
    return folder


@pytest.fixture(scope="session")
def sample_depth_map(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """A function that simulates a depth map of a sample photo, `street` by the name, in a second: its file."""
    from linecad.dataset.depth_maps import MapKind, corrupted_depth, map_arrays, map_pixels
    from linecad.dataset.store import write_depth_map
    from linecad.dataset.truth import NOTHING
    from linecad.dataset.walls import walls_of_quads

    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).resolve().parents[1] / "samples")
        make_samples, raycaster = (importlib.import_module(name) for name in ("make_samples", "raycaster"))

    def simulate(name: str, width: float = 0.012, seed: int = 1, kind: MapKind = "z") -> Path:
        sample = make_samples.SAMPLES[name]
        view, faces = make_samples.view_of(sample, make_samples.WIDTH), sample.build().faces
        rows, columns = map_pixels(view.height, view.width)
        pixels = np.stack(np.meshgrid(columns, rows), axis=-1).astype(float)
        _, depth, index = raycaster.see(faces, view, pixels)
        corners = np.array([face.corners() for face in faces])
        walls = np.append(walls_of_quads(corners, np.zeros(len(faces), int)), NOTHING)[index]
        found = corrupted_depth(depth, walls, width, np.random.default_rng(seed), kind)
        path = tmp_path_factory.mktemp("depth") / f"{name}.depth.npz"
        write_depth_map(map_arrays(found, kind, view.matrix, view.width, view.height), path)
        return path

    return simulate


class CapabilityHeader(ctypes.Structure):
    """Linux's struct __user_cap_header_struct."""

    _fields_ = [("version", ctypes.c_uint32), ("process", ctypes.c_int)]


class CapabilityWord(ctypes.Structure):
    """Linux's struct __user_cap_data_struct: 32 capabilities."""

    _fields_ = [("effective", ctypes.c_uint32), ("permitted", ctypes.c_uint32), ("inheritable", ctypes.c_uint32)]


CAPABILITY_VERSION_3 = 0x20080522
IGNORING_PERMISSIONS = 1 << 1 | 1 << 2  # CAP_DAC_OVERRIDE and CAP_DAC_READ_SEARCH


@pytest.fixture
def bound_by_permissions() -> Iterator[None]:
    """File permissions bind the test even where root runs it, as CI does; nothing else changes."""
    if not hasattr(os, "geteuid"):
        pytest.skip("no permissions that a test could take away on this system")
    if os.geteuid() != 0:
        yield
        return
    if sys.platform != "linux":
        pytest.skip("only on Linux can root be bound by permissions")
    libc = ctypes.CDLL(None, use_errno=True)
    header, words = CapabilityHeader(CAPABILITY_VERSION_3, 0), (CapabilityWord * 2)()

    def call(function: str) -> None:
        if getattr(libc, function)(ctypes.byref(header), words) != 0:
            raise OSError(ctypes.get_errno(), f"{function}: {os.strerror(ctypes.get_errno())}")

    call("capget")
    before = words[0].effective
    words[0].effective = before & ~IGNORING_PERMISSIONS
    call("capset")
    try:
        yield
    finally:
        words[0].effective = before
        call("capset")
