"""The add-on for Blender and the macro for FreeCAD, each as one file that its program installs.

Their sources are several modules, of which both share some. A program wants one file and knows nothing of linecad, so
a module stands in the file in place of the line that imports it.
"""

import ast
import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from linecad.io.files import write_bytes_atomically

_PACKAGE = "exporters.addons"
_FOLDER = Path(__file__).parent
_DATE = (1980, 1, 1, 0, 0, 0)  # the real one would make each archive another
_COMMAND = 'WRITTEN_BY = ""'  # in running.py
_VERSION = '"version": (0, 0, 0)'  # in bl_info, which Blender reads without running the file
_MANIFEST_VERSION = 'version = "0.0.0"'


class Addon(NamedTuple):
    """What linecad writes for a program."""

    file: str  # what the add-on is called unless another name is given
    how: str  # how to install it, in one clause
    build: Callable[[str, str], bytes]  # the file's bytes, from the version and the path of the command


def build_blender(version: str, command: str) -> bytes:
    """A ZIP that Blender 4.2 installs as an extension and older ones as an add-on."""
    numbers = tuple(map(int, version.split(".")))
    code = _replaced(_with_command("blender.panel", command), _VERSION, f'"version": {numbers}')
    manifest = (_FOLDER / "blender" / "blender_manifest.toml").read_text(encoding="utf-8")
    files = {
        "__init__.py": code,
        "blender_manifest.toml": _replaced(manifest, _MANIFEST_VERSION, f'version = "{version}"'),
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            # In a folder: what older ones take from the archive lands among the folders of all add-ons.
            archive.writestr(zipfile.ZipInfo(f"linecad/{name}", _DATE), text.encode(), zipfile.ZIP_DEFLATED)
    return packed.getvalue()


def build_freecad(_version: str, command: str) -> bytes:
    """The macro."""
    return _with_command("freecad.dialog", command).encode()


ADDONS = {
    "blender": Addon(
        "linecad-blender.zip",
        "in Blender: Edit > Preferences > Get Extensions > Install from Disk (before 4.2: Add-ons > Install)",
        build_blender,
    ),
    "freecad": Addon("linecad.FCMacro", "in FreeCAD: put it in the folder that Macro > Macros names", build_freecad),
}


def write_addon(program: str, path: Path, version: str, command: str) -> None:
    """Write the add-on for one of ADDONS. OutputError where that cannot be done.

    `version` is that of linecad, `command` the path of the linecad to run where none is on PATH; it may be empty.
    """
    write_bytes_atomically(path, ADDONS[program].build(version, command))


def _with_command(module: str, command: str) -> str:
    return _replaced(joined(module), _COMMAND, f"WRITTEN_BY = {command!r}")


def _replaced(text: str, old: str, new: str) -> str:
    if text.count(old) != 1:
        raise AssertionError(f"{old} stands {text.count(old)} times in a source of an add-on, expected once")
    return text.replace(old, new)


def joined(module: str) -> str:
    """The text of a module of this package below those that it imports from here, each once and after what it needs."""
    texts: dict[str, str] = {}
    _collect(f"{_PACKAGE}.{module}", texts)
    docstring = ast.get_docstring(ast.parse(_source(f"{_PACKAGE}.{module}")), clean=False)
    return f'"""{docstring}"""\n\n' + "\n\n".join(text.strip("\n") + "\n" for text in texts.values())


def _collect(module: str, texts: dict[str, str]) -> None:
    """Add the texts of modules to `texts` by their names, without docstrings and imports from this package."""
    lines = _source(module).splitlines(keepends=True)
    docstring, *statements = ast.parse("".join(lines)).body
    gone = [docstring]
    for node in statements:
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith(f"{_PACKAGE}."):
            gone.append(node)
            if node.module not in texts:
                _collect(node.module, texts)
    for node in reversed(gone):
        del lines[node.lineno - 1 : node.end_lineno]
    texts[module] = "".join(lines)


def _source(module: str) -> str:
    path = _FOLDER.joinpath(*module.removeprefix(f"{_PACKAGE}.").split("."))
    return path.with_suffix(".py").read_text(encoding="utf-8")
