"""Let the macro convert a photo in FreeCAD: check_freecad_macro.py MACRO LINECAD PHOTO CAMERA

LINECAD is the path of the command. PHOTO lies in a folder that can be written, and nobody has corrected it yet.
"""

import sys
from pathlib import Path

from check_freecad import report_from
from verdict import passed

INSIDE = Path(__file__).with_name("macro_in_freecad.py")


def main(macro, command, photo, calibration):
    places = {"CHECK_MACRO": macro, "CHECK_PHOTO": photo, "CHECK_CAMERA": calibration}
    told = {name: str(Path(place).resolve()) for name, place in places.items()}
    report = report_from(INSIDE, told | {"CHECK_COMMAND": command})
    print("\n".join(report))
    return 0 if passed(report) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
