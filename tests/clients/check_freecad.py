"""Open a STEP, DXF or IFC in FreeCAD: check_freecad.py FILE.step|.dxf|.ifc EXPECTATION.json [--gui] [--guide GUIDE.md]

FreeCAD opens IFC with ifcopenshell, which --libraries DIR has for its Python. With --gui the window is loaded too, on
no screen, and colours are looked at; they are no part of the model itself. With --guide the Python of the guide opens
the file instead, in its window, and the names in the tree are looked at.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from verdict import judge, passed

INSIDE = Path(__file__).with_name("inside_freecad.py")
BY_GUIDE = Path(__file__).with_name("guide_in_freecad.py")
MOST_SECONDS = 280
LAST_WORDS = 400  # characters of FreeCAD's own output to show where it said nothing else


def report_of(path, expectation, gui, program="freecadcmd", libraries=None, guide=None):
    """What the checker says that runs inside FreeCAD, line by line; `libraries` is a folder of more modules for it.

    With a `guide`, its Python opens the file.
    """
    told = {
        "CHECK_FILE": str(path.resolve()),
        "CHECK_EXPECTATION": str(expectation.resolve()),
        "CHECK_GUI": "1" if gui else "",
        "CHECK_GUIDE": "" if guide is None else str(guide.resolve()),
    }
    return report_from(INSIDE if guide is None else BY_GUIDE, told, program, libraries)


def report_from(script, told, program="freecadcmd", libraries=None):
    """What a checker says that FreeCAD runs, which gets what it must know by the environment.

    `libraries` is a folder of more modules for it.
    """
    with tempfile.TemporaryDirectory(prefix="freecad-") as folder:
        report = Path(folder) / "report.txt"
        # freecadcmd takes every word for a file to open, so arguments come by the environment. Its own settings, and
        # those of whoever runs this, must not matter.
        environment = (
            os.environ
            | {
                "HOME": folder,
                "XDG_RUNTIME_DIR": folder,
                "CHECK_REPORT": str(report),
                "BROWSER": "true",  # a program that shows nothing
                "PYTHONPATH": os.pathsep.join(map(str, [script.parent, *([libraries.resolve()] if libraries else [])])),
                "QT_QPA_PLATFORM": "offscreen",
                "QTWEBENGINE_DISABLE_SANDBOX": "1",
            }
            | told
        )
        command = [program, "-u", f"{folder}/user.cfg", "-s", f"{folder}/system.cfg", str(script)]
        try:
            ended = subprocess.run(
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=MOST_SECONDS,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired) as error:
            return failure(str(error))
        if report.is_file():
            return report.read_text(encoding="utf-8").splitlines()
    # A script's exception ends freecadcmd with 0.
    said = ended.stdout.decode(errors="replace").strip()[-LAST_WORDS:]
    return failure(f"{program} ended with {ended.returncode} and gave no verdict: {said!r}")


def failure(problem):
    """The report of a check that FreeCAD did not come to."""

    def check(findings):
        findings.need(False, problem)
        return "FreeCAD"

    return judge(check)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("expectation", type=Path)
    parser.add_argument("--gui", action="store_true")
    parser.add_argument("--libraries", type=Path)
    parser.add_argument("--guide", type=Path)
    chosen = parser.parse_args()
    report = report_of(chosen.file, chosen.expectation, chosen.gui, libraries=chosen.libraries, guide=chosen.guide)
    print("\n".join(report))
    return 0 if passed(report) else 1


if __name__ == "__main__":
    sys.exit(main())
