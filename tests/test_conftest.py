"""In CI a test that is skipped counts as a failure, whichever way it skips, and permissions bind root."""

import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

CONFTEST = Path(__file__).with_name("conftest.py")
IN_PROCESSES = ("-p", "xdist", "--numprocesses", "1")
SKIPPING = {
    "in_the_test": "import pytest\ndef test_it():\n    pytest.skip('too cold')\n",
    "by_a_mark": "import pytest\n@pytest.mark.skipif(True, reason='too cold')\ndef test_it():\n    pass\n",
    "in_a_fixture": (
        "import pytest\n@pytest.fixture\ndef sun():\n    pytest.skip('too cold')\ndef test_it(sun):\n    pass\n"
    ),
    "the_whole_module": "import pytest\npytest.skip('too cold', allow_module_level=True)\n",
}
EXAMPLES = "from hypothesis import settings\ndef test_it():\n    assert settings.default.max_examples == {}\n"
OTHERS = {
    "fails_as_expected": "import pytest\n@pytest.mark.xfail\ndef test_it():\n    assert False\n",
    "needs_photographs": "def test_it(photographs):\n    assert (photographs / 'castle').is_dir()\n",
    "tiers": "import pytest\ndef test_it():\n    pass\n@pytest.mark.thorough\ndef test_more():\n    pass\n",
    "few_examples": EXAMPLES.format(25),
    "many_examples": EXAMPLES.format(100),
}


@dataclass(frozen=True)
class Run:
    """What pytest says of these files under the conftest.py of the project, in a process of its own."""

    code: int
    text: str

    def of(self, name: str) -> str:
        """The line of the summary about the test in a file, or about the file."""
        found = [line for line in self.text.splitlines() if re.match(rf"[A-Z]+ (\[1\] )?test_{name}\.py", line)]
        assert len(found) == 1, self.text
        return found[0]


def run(folder: Path, no_skips: str, *options: str, data: str = "") -> Run:
    (folder / "conftest.py").write_text(CONFTEST.read_text())
    for name, text in {**SKIPPING, **OTHERS}.items():
        (folder / f"test_{name}.py").write_text(text)
    environment = os.environ | {
        "LINECAD_NO_SKIPS": no_skips,
        "LINECAD_DATA": data,
        "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        "COLUMNS": "1000",  # to which pytest cuts lines
    }
    command = [
        sys.executable, "-m", "pytest", "-q", "-rA", "-p", "no:cacheprovider",
        "-W", "ignore::pytest.PytestUnknownMarkWarning", "--continue-on-collection-errors", *options,
    ]  # fmt: skip
    ended = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    return Run(ended.returncode, ended.stdout)


@pytest.fixture(scope="module", params=[(), IN_PROCESSES], ids=["in one process", "in several"])
def without_skips(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run(tmp_path_factory.mktemp("without"), "1", *request.param)


@pytest.fixture(scope="module")
def thorough_with_skips(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("with")
    (folder / "photographs" / "castle").mkdir(parents=True)
    return run(folder, "", "--thorough", data=str(folder / "photographs"))


@pytest.mark.parametrize("where", SKIPPING)
def test_skip_is_a_failure_when_no_skip_is_allowed(without_skips: Run, where: str) -> None:
    assert without_skips.code != 0
    said = without_skips.of(where)
    assert said.startswith(("FAILED", "ERROR"))
    assert "too cold" in said
    assert "allows no skip" in said


def test_skip_is_a_skip_elsewhere(thorough_with_skips: Run) -> None:
    assert thorough_with_skips.of("in_the_test").startswith("SKIPPED")


def test_expected_failure_is_no_skip(without_skips: Run) -> None:
    assert without_skips.of("fails_as_expected").startswith("XFAIL")


def test_without_photographs_a_test_is_skipped_and_says_why_even_where_no_skip_is_allowed(without_skips: Run) -> None:
    assert without_skips.of("needs_photographs").startswith("SKIPPED")
    assert "LINECAD_DATA" in without_skips.of("needs_photographs")


def test_photographs_are_where_the_caller_says(thorough_with_skips: Run) -> None:
    assert thorough_with_skips.of("needs_photographs").startswith("PASSED")


def test_a_folder_of_photographs_that_is_not_there_is_a_failure(tmp_path: Path) -> None:
    result = run(tmp_path, "", "test_needs_photographs.py", data=str(tmp_path / "nowhere"))
    assert result.code != 0
    assert "nowhere, which is not a folder" in result.text


def test_what_is_thorough_runs_only_where_that_is_asked_for(without_skips: Run, thorough_with_skips: Run) -> None:
    assert "test_tiers.py::test_it" in without_skips.of("tiers")  # alone
    assert "test_more" not in without_skips.text
    assert "PASSED test_tiers.py::test_more" in thorough_with_skips.text


def test_a_thorough_run_tries_more_examples(without_skips: Run, thorough_with_skips: Run) -> None:
    assert without_skips.of("few_examples").startswith("PASSED")
    assert thorough_with_skips.of("many_examples").startswith("PASSED")


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
