"""Everything that a record is made of can be had from `linecad.scene`, wherever in the package it lives."""

import ast
import pickle
from pathlib import Path

import linecad.scene

FOLDER = Path(linecad.scene.__file__).parent


def defined(path: Path) -> set[str]:
    """The classes, functions and names that a module defines."""
    found = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        match node:
            case ast.ClassDef() | ast.FunctionDef():
                found.add(node.name)
            case ast.Assign():
                found |= {name.id for target in node.targets for name in ast.walk(target) if isinstance(name, ast.Name)}
            case ast.AnnAssign(target=ast.Name()):
                found.add(node.target.id)
    return found


def test_the_package_has_every_name_of_its_modules() -> None:
    names = set().union(*map(defined, FOLDER.glob("[a-z]*.py")))
    assert {"AXES", "DETAIL", "ROLES", "Face", "Scene"} <= names
    assert names == set(linecad.scene.__all__)


def test_pickles_that_name_the_package_load() -> None:
    # So they were written while linecad.scene was one module.
    assert pickle.loads(b"clinecad.scene\nScene\n.") is linecad.scene.Scene
