"""The pictures of docs/guide/freecad.md, blender.md and usd.md, made without a screen.

    python docs/guide/screenshots/make.py [freecad] [blender] [usd] [freecad-macro] [blender-addon] [--bpy PYTHON]

Needs linecad, FreeCAD with xvfb-run, and Blender on the path; for the USD stage a Python with the module bpy, because
Debian's Blender was built without USD. Without a word all pictures are made, in docs/guide/.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

GUIDE = Path(__file__).resolve().parents[1]
ROOT = GUIDE.parents[1]
HERE = Path(__file__).parent
SAMPLE = ROOT / "samples" / "courtyard.jpg"
SCREEN = "1500x900x24"
WIDEST = 1500  # px
QUALITY = 82  # of the JPEG
LIMIT = 600  # s
PICTURES = ["freecad", "blender", "usd", "freecad-macro", "blender-addon"]


def main() -> None:
    """Export the sample once and make the pictures that are asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("pictures", nargs="*", choices=[*PICTURES, []], default=[])
    parser.add_argument("--bpy", default=sys.executable, help="a Python that has the module bpy")
    parsed = parser.parse_args()
    wanted = parsed.pictures or PICTURES
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        shutil.copy(SAMPLE, folder)
        files = {suffix: folder / f"{SAMPLE.stem}.{suffix}" for suffix in ("step", "glb", "usdz")}
        outputs = [word for file in files.values() for word in ("-o", str(file))]
        camera = str(SAMPLE.with_suffix(".json"))
        command = [sys.executable, "-m", "linecad", "convert", str(SAMPLE), "--camera", camera, *outputs]
        run([*command, "--option", "tubes=on", "--quiet"], PYTHONPATH=str(ROOT))
        viewer, photo = str(HERE / "blender_view.py"), str(SAMPLE)
        for name in wanted:
            picture = folder / f"{name}.png"
            if name in ("freecad-macro", "blender-addon"):
                with_addon(folder, name, picture)
            elif name == "freecad":
                freecad(folder, files["step"], picture)
            elif name == "blender":
                blender = ["blender", "--background", "--factory-startup", "--python-exit-code", "3"]
                run([*blender, "--python", viewer, "--", str(files["glb"]), photo, str(picture)])
            else:
                run([parsed.bpy, viewer, str(files["usdz"]), photo, str(picture)])
            save(picture, GUIDE / f"{name}.jpg")


def freecad(folder: Path, step: Path, picture: Path) -> None:
    """FreeCAD's window on a screen of its own, with preferences of its own."""
    settings = ["-u", str(folder / "user.cfg"), "-s", str(folder / "system.cfg")]
    command = ["xvfb-run", "-a", "-s", f"-screen 0 {SCREEN}", "freecad", *settings, str(HERE / "freecad_view.py")]
    run(command, SCENE_STEP=str(step), PICTURE=str(picture), QTWEBENGINE_DISABLE_SANDBOX="1", HOME=str(folder))


def with_addon(folder: Path, name: str, picture: Path) -> None:
    """The window of a program in which its add-on converts the sample, in a home of its own."""
    program = name.partition("-")[0]
    home, command = folder / f"home-{program}", folder / "linecad"
    home.mkdir()
    command.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m linecad "$@"\n')
    command.chmod(0o755)
    run([str(command), "addon", program, "-o", str(home)])
    photo, camera = str(folder / SAMPLE.name), str(folder / "camera.json")
    shutil.copy(SAMPLE.with_suffix(".json"), camera)
    screen = ["xvfb-run", "-a", "-s", f"-screen 0 {SCREEN}", program]
    if program == "blender":
        width, height, _ = SCREEN.split("x")
        options = ["--factory-startup", "--enable-event-simulate", "--window-geometry", "0", "0", width, height]
        words = [str(home / "linecad-blender.zip"), str(command), photo, camera, str(picture)]
        script = ["--python", str(HERE / "addon_view.py"), "--", *words]
        run([*screen, *options, *script], HOME=str(home), XDG_CONFIG_HOME=str(home / "config"))
    else:
        settings = ["-u", str(home / "user.cfg"), "-s", str(home / "system.cfg"), str(HERE / "macro_view.py")]
        told = {"PHOTO": photo, "CAMERA": camera, "PICTURE": str(picture), "LINECAD": str(command)}
        macro = str(home / "linecad.FCMacro")
        run([*screen, *settings], **told, MACRO=macro, QTWEBENGINE_DISABLE_SANDBOX="1", HOME=str(home))


def run(command: list[str], **environment: str) -> None:
    """Run a program; SystemExit with what it said last where it fails."""
    ended = subprocess.run(
        command, env=os.environ | environment, capture_output=True, text=True, errors="replace", timeout=LIMIT,
        check=False,
    )  # fmt: skip
    if ended.returncode != 0:
        raise SystemExit(f"{command[0]} ended with {ended.returncode}:\n{(ended.stdout + ended.stderr)[-1500:]}")


def save(picture: Path, path: Path) -> None:
    """As JPEG of a handy size."""
    image = Image.open(picture).convert("RGB")
    image.thumbnail((WIDEST, WIDEST))
    image.save(path, quality=QUALITY, optimize=True)


if __name__ == "__main__":
    main()
