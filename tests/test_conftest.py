"""In CI a test that is skipped counts as a failure, whichever way it skips, and permissions bind root."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

CONFTEST = Path(__file__).with_name("conftest.py")
IN_PROCESSES = ("-p", "xdist", "--numprocesses", "1")
SKIPPING = {
    "in the test": "import pytest\ndef test_it():\n    pytest.skip('too cold')\n",
    "by a mark": "import pytest\n@pytest.mark.skipif(True, reason='too cold')\ndef test_it():\n    pass\n",
    "in a fixture": (
        "import pytest\n@pytest.fixture\ndef sun():\n    pytest.skip('too cold')\ndef test_it(sun):\n    pass\n"
    ),
    "the whole module": "import pytest\npytest.skip('too cold', allow_module_level=True)\n",
}


def run(folder: Path, text: str, no_skips: str, *options: str, data: str = "") -> subprocess.CompletedProcess[str]:
    (folder / "conftest.py").write_text(CONFTEST.read_text())
    (folder / "test_it.py").write_text(text)
    environment = os.environ | {
        "LINECAD_NO_SKIPS": no_skips,
        "LINECAD_DATA": data,
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
    }
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        *options,
        "test_it.py",
    ]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("text", SKIPPING.values(), ids=SKIPPING.keys())
def test_skip_is_a_failure_when_no_skip_is_allowed(tmp_path: Path, text: str) -> None:
    result = run(tmp_path, text, "1")
    assert result.returncode != 0
    assert "too cold" in result.stdout
    assert "allows no skip" in result.stdout


@pytest.mark.parametrize("where", ["in the test", "the whole module"])
def test_so_it_is_where_tests_run_in_several_processes(tmp_path: Path, where: str) -> None:
    result = run(tmp_path, SKIPPING[where], "1", *IN_PROCESSES)
    assert result.returncode != 0
    assert "allows no skip" in result.stdout


def test_skip_is_a_skip_elsewhere(tmp_path: Path) -> None:
    result = run(tmp_path, SKIPPING["in the test"], "")
    assert result.returncode == 0
    assert "1 skipped" in result.stdout


def test_expected_failure_is_no_skip(tmp_path: Path) -> None:
    result = run(tmp_path, "import pytest\n@pytest.mark.xfail\ndef test_it():\n    assert False\n", "1")
    assert result.returncode == 0
    assert "1 xfailed" in result.stdout


NEEDS_PHOTOGRAPHS = "def test_it(photographs):\n    assert (photographs / 'castle').is_dir()\n"


@pytest.mark.parametrize("options", [(), IN_PROCESSES])
def test_without_photographs_a_test_is_skipped_and_says_why_even_where_no_skip_is_allowed(
    tmp_path: Path, options: tuple[str, ...]
) -> None:
    result = run(tmp_path, NEEDS_PHOTOGRAPHS, "1", "-rs", *options)
    assert result.returncode == 0
    assert "1 skipped" in result.stdout
    assert "LINECAD_DATA" in result.stdout


def test_photographs_are_where_the_caller_says(tmp_path: Path) -> None:
    (tmp_path / "photographs" / "castle").mkdir(parents=True)
    result = run(tmp_path, NEEDS_PHOTOGRAPHS, "1", data=str(tmp_path / "photographs"))
    assert result.returncode == 0
    assert "1 passed" in result.stdout


def test_a_folder_of_photographs_that_is_not_there_is_a_failure(tmp_path: Path) -> None:
    result = run(tmp_path, NEEDS_PHOTOGRAPHS, "", data=str(tmp_path / "nowhere"))
    assert result.returncode != 0
    assert "nowhere, which is not a folder" in result.stdout


@pytest.mark.usefixtures("bound_by_permissions")
def test_permissions_bind_whoever_runs_the_tests(tmp_path: Path) -> None:
    path = tmp_path / "secret"
    path.write_text("")
    path.chmod(0)
    with pytest.raises(PermissionError):
        path.read_text()
    tmp_path.chmod(0o500)
    with pytest.raises(PermissionError):
        (tmp_path / "new").write_text("")


TIERS = "import pytest\ndef test_it():\n    pass\n@pytest.mark.thorough\ndef test_more():\n    pass\n"


@pytest.mark.parametrize(("options", "says"), [((), "1 passed, 1 deselected"), (("--thorough",), "2 passed")])
def test_what_is_thorough_runs_only_where_that_is_asked_for(
    tmp_path: Path, options: tuple[str, ...], says: str
) -> None:
    result = run(tmp_path, TIERS, "1", "-W", "ignore::pytest.PytestUnknownMarkWarning", *options)
    assert result.returncode == 0
    assert says in result.stdout


@pytest.mark.parametrize(("options", "count"), [((), 25), (("--thorough",), 100)])
def test_a_thorough_run_tries_more_examples(tmp_path: Path, options: tuple[str, ...], count: int) -> None:
    text = f"from hypothesis import settings\ndef test_it():\n    assert settings.default.max_examples == {count}\n"
    assert run(tmp_path, text, "", *options).returncode == 0
