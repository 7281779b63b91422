"""The rules of the house: imports go downwards, heavy libraries wait, nothing in a file belongs to one machine."""

import ast
import importlib.metadata
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("linecad", "exporters", "solver")

# A package imports only what stands in rows above its own; packages of one row do not know each other.
LAYERS = (
    ("linecad", "linecad.errors", "linecad.arrays", "linecad.progress", "linecad.threads"),
    ("linecad.directions",),
    ("linecad.line_graph",),
    ("linecad.scene",),
    ("linecad.geometry", "linecad.io", "linecad.confidence"),
    ("linecad.options", "linecad.corrections"),
    ("linecad.lines",),
    ("linecad.graph",),
    ("linecad.camera",),
    ("linecad.depth",),
    ("linecad.decide",),
    ("linecad.ties",),
    ("linecad.model", "linecad.dataset"),
    ("linecad.finding",),
    ("linecad.pipeline", "linecad.outputs"),
    ("linecad.convert",),
    ("linecad.batch", "linecad.editing", "linecad.evaluation"),
    ("linecad.cli",),
    ("linecad.__main__",),
)
EXCEPTIONS = {("linecad.evaluation", "linecad.dataset")}
# All that solver and exporters know of linecad; linecad calls them from its options upwards.
KNOWN_TO_THE_PACKAGES = {
    "linecad.errors", "linecad.arrays", "linecad.directions", "linecad.line_graph", "linecad.scene", "linecad.io.files",
    "linecad.io.locks",
}  # fmt: skip
FIRST_THAT_KNOWS_THE_PACKAGES = "linecad.options"

MOST_MODULES = 15  # directly in linecad
MOST_LINES_OF_A_FILE = 350
MOST_LINES_OF_A_FUNCTION = 60
MOST_PARAMETERS = 7

HEAVY = {
    "build123d",
    "cv2",
    "dask",
    "distributed",
    "ezdxf",
    "highspy",
    "ifcopenshell",
    "lensfunpy",
    "mitsuba",
    "networkx",
    "OCP",
    "OpenEXR",
    "openskp",
    "PIL",
    "pillow_heif",
    "pxr",
    "pyscipopt",
    "rhino3dm",
    "scipy",
    "shapely",
    "starlette",
    "trimesh",
    "uvicorn",
}
LONGEST_HELP = 0.5  # s of computing, for a clock would measure the neighbours too; `linecad --help` takes 0.1

# Hosts that a file may link to: standards, papers, the tools' own documentation.
HOSTS = {
    "127.0.0.1",  # the page of linecad edit; with the two next ones also in its tests
    "example.org",
    "localhost",
    "arxiv.org",
    "creativecommons.org",
    "developer.rhino3d.com",
    "docs.opencv.org",
    "docs.python.org",
    "doi.org",
    "ezdxf.readthedocs.io",
    "github.com",
    "help.autodesk.com",
    "openusd.org",
    "paulbourke.net",
    "registry.khronos.org",
    "semver.org",
    "standards.buildingsmart.org",
    "www.inkscape.org",  # the namespace of its layers
    "www.iso.org",
    "www.khronos.org",
    "www.loc.gov",
    "www.rfc-editor.org",
    "www.scipopt.org",
    "www.steptools.com",
    "www.w3.org",
}
BYTES_OF_ANY_KIND = "tests/fuzz/corpus/"  # what the fuzzer made is no text of ours
HOST_OF_A_REGISTRY = re.compile(r"[\w.-]*(?:pypi|npmjs|pythonhosted|artifactory|nexus)[\w-]*\.[a-z]{2,}", re.IGNORECASE)
PATH_OF_A_MACHINE = re.compile(r"(?<![\w.*}>$-])/(?:home|root|Users|work|workspace|tmp|mnt|media|srv|opt)/[\w.-]+")


def python_files(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


def name_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(path): path for path in python_files(*PACKAGES)}
ROW = {name: row for row, names in enumerate(LAYERS) for name in names}


def without_functions(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes of a tree that run when the module is imported."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield child
            yield from without_functions(child)


def imported(module: str, walk: Callable[[ast.AST], Iterator[ast.AST]]) -> Iterator[str]:
    """Every module that a module imports where `walk` goes."""
    path = MODULES[module]
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*start, *([node.module] if node.module else [])])
            names = [f"{base}.{alias.name}" for alias in node.names]
            yield from (name if name in MODULES else base for name in names)


@cache
def imports_of(module: str) -> set[str]:
    """The modules of the project that a module imports anywhere."""
    return {name for name in imported(module, ast.walk) if name in MODULES}


def package_of(module: str) -> str:
    """What a module counts as: the package directly in linecad, or the module there; solver or exporters."""
    return ".".join(module.split(".")[:2]) if module.startswith("linecad.") else module.split(".")[0]


def test_every_package_of_linecad_has_a_row() -> None:
    homeless = {package_of(module) for module in MODULES if module.split(".")[0] == "linecad"} - ROW.keys()
    assert not homeless, f"say in LAYERS where {sorted(homeless)} stand"
    assert not ROW.keys() - {package_of(module) for module in MODULES}


# The front door, `linecad` itself, loads what stands behind it when that is used (tests/linecad/test_init.py).
@pytest.mark.parametrize("module", sorted(name for name in MODULES if name.startswith("linecad.")))
def test_imports_of_linecad_go_downwards(module: str) -> None:
    own = package_of(module)
    others = {package_of(name) for name in imports_of(module)} - {own, "linecad"}
    row = {name: ROW.get(name, ROW[FIRST_THAT_KNOWS_THE_PACKAGES] - 1) for name in others}
    assert {name for name in others if row[name] >= ROW[own] and (own, name) not in EXCEPTIONS} == set()


@pytest.mark.parametrize("module", sorted(name for name in MODULES if name.split(".")[0] != "linecad"))
def test_solver_and_exporters_know_only_records_and_errors(module: str) -> None:
    package = module.split(".")[0]
    assert {name for name in imports_of(module) if name.split(".")[0] != package} <= KNOWN_TO_THE_PACKAGES


def in_rooms(module: str) -> str:
    """The package that a module lies in, or itself where it lies in a top package."""
    path = MODULES[module]
    folder = path.parent.relative_to(ROOT).parts
    return module if len(folder) == 1 else ".".join(folder)


@pytest.mark.parametrize("of", [str, in_rooms], ids=["modules", "packages"])
def test_nothing_imports_itself_by_a_detour(of: Callable[[str], str]) -> None:
    # Imports within functions count too; only the front door may look up.
    arrows: dict[str, set[str]] = {}
    for module in MODULES:
        names = imports_of(module)
        if module != "linecad":
            arrows.setdefault(of(module), set()).update(of(name) for name in names - {"linecad"})
    TopologicalSorter({one: others - {one} for one, others in arrows.items()}).prepare()  # raises CycleError


def test_linecad_has_few_modules_of_its_own() -> None:
    assert len(list((ROOT / "linecad").glob("*.py"))) <= MOST_MODULES


@pytest.mark.parametrize("path", python_files(*PACKAGES), ids=name_of)
def test_files_and_functions_are_short(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= MOST_LINES_OF_A_FILE
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            given = node.args
            names = [argument.arg for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
            assert (node.end_lineno or node.lineno) - node.lineno < MOST_LINES_OF_A_FUNCTION, node.name
            assert len(names) - (names[:1] in (["self"], ["cls"])) <= MOST_PARAMETERS, node.name


@pytest.mark.parametrize("path", python_files(*PACKAGES, "samples"), ids=name_of)
def test_module_starts_by_saying_what_it_holds(path: Path) -> None:
    module = ast.parse(path.read_text(encoding="utf-8"))
    assert ast.get_docstring(module)
    assert module.body[0].lineno == 1


@pytest.mark.parametrize("package", PACKAGES)
def test_package_is_typed(package: str) -> None:
    assert (ROOT / package / "py.typed").is_file()


def help_in_a_fresh_process(*options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *options, "-m", "linecad", "--help"]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)


def test_help_loads_no_heavy_library() -> None:
    report = help_in_a_fresh_process("-X", "importtime").stderr
    loaded = {
        line.split("|")[-1].strip().split(".")[0] for line in report.splitlines() if line.startswith("import time")
    }
    assert "linecad" in loaded
    assert loaded & HEAVY == set()


def test_help_answers_at_once() -> None:
    def seconds() -> float:
        before = os.times()
        help_in_a_fresh_process()
        after = os.times()
        return after.children_user + after.children_system - before.children_user - before.children_system

    assert min(seconds() for _ in range(3)) < LONGEST_HELP


def test_readme_names_every_command() -> None:
    usage = help_in_a_fresh_process().stdout
    found = re.search(r"\{([\w,-]+)\}", usage)
    assert found, "the help lists the commands in braces"
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [command for command in found[1].split(",") if f"linecad {command}" not in readme] == []


def tracked_texts() -> list[tuple[str, str]]:
    """Name and text of every file of the checkout that git keeps or would keep, except pictures and models."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if listing.returncode != 0:
        pytest.skip("this is not a git checkout")
    texts = []
    for name in filter(None, listing.stdout.split("\0")):
        path = ROOT / name
        if not path.is_file() or name.startswith(BYTES_OF_ANY_KIND):
            continue
        data = path.read_bytes()
        if b"\0" not in data:
            texts.append((name, data.decode("utf-8")))
    assert "pyproject.toml" in [name for name, _ in texts]
    return texts


def test_no_file_names_a_path_of_one_machine() -> None:
    found = {name: PATH_OF_A_MACHINE.findall(text) for name, text in tracked_texts()}
    assert {name: paths for name, paths in found.items() if paths} == {}


def test_no_file_names_a_package_registry() -> None:
    found = {name: HOST_OF_A_REGISTRY.findall(text) for name, text in tracked_texts()}
    assert {name: hosts for name, hosts in found.items() if hosts} == {}


def test_files_link_only_to_hosts_that_we_know() -> None:
    found = {name: set(re.findall(r"https?://([\w.-]+)", text)) - HOSTS for name, text in tracked_texts()}
    assert {name: hosts for name, hosts in found.items() if hosts} == {}


def pinned_versions() -> dict[str, str]:
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    requirements = [Requirement(line) for line in lines if line and not line.startswith("#")]
    for requirement in requirements:
        assert requirement.url is None
        assert re.fullmatch(r"==[\w.]+", str(requirement.specifier)), requirement
    return {canonicalize_name(requirement.name): str(requirement.specifier)[2:] for requirement in requirements}


def test_constraints_pin_every_dependency_to_a_version_that_we_allow() -> None:
    pinned = pinned_versions()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [Requirement(text) for text in project["dependencies"] + project["optional-dependencies"]["dev"]]
    assert [str(each) for each in wanted if pinned.get(canonicalize_name(each.name)) not in each.specifier] == []
    assert "linecad" not in pinned


def test_constraints_pin_what_the_dependencies_bring() -> None:
    """Every library that an installed, pinned library asks for on this machine is pinned too."""
    pinned = pinned_versions()
    here = {canonicalize_name(each.metadata["Name"]) for each in importlib.metadata.distributions()}
    assert canonicalize_name("numpy") in here
    brought = {
        canonicalize_name(need.name): name
        for name in pinned
        if canonicalize_name(name) in here  # not what only an extra asks for that this machine does without
        for need in map(Requirement, importlib.metadata.requires(name) or [])
        if need.marker is None or need.marker.evaluate({"extra": ""})
    }
    assert {name: asker for name, asker in brought.items() if name not in pinned} == {}


def test_make_alone_lists_the_targets() -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    listing = subprocess.run(["make"], cwd=ROOT, env=environment, capture_output=True, text=True, check=True).stdout
    targets = ["demo", "test", "test-all", "lint", "check", "results", "clean"]
    assert re.findall(r"^make ([\w-]+) ", listing, re.MULTILINE) == targets
