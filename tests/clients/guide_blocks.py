"""The Python that a guide shows, as the programs that it is about must run it.

Runs in the Pythons of FreeCAD and Blender too, so it needs nothing but the standard library of Python 3.10.
"""

import re
from pathlib import Path

BLOCK = re.compile(r"```python\n(.+?)```", re.DOTALL)


def blocks_of(guide: Path) -> list[str]:
    """The blocks of Python in a guide, in their order; there is at least one."""
    blocks = BLOCK.findall(guide.read_text(encoding="utf-8"))
    if not blocks:
        raise ValueError(f"{guide.name} shows no Python")
    return blocks


def run_block(block: str, guide: Path) -> None:
    """Run a block as a reader pastes it; whatever it raises comes through."""
    exec(compile(block, guide.name, "exec"), {"__name__": "__main__"})
