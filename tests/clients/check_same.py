"""Run an export three times and need the same bytes: check_same.py COMMAND ... {OUT}/file.step ...

Each run is a process of its own with another folder in place of {OUT}, another seed of Python's hashes and, because
archives tell times in steps of two seconds, another time. Nothing may be left over: in {OUT} lie only the files that
the command names and what is named after one of them, in the folder for temporary files nothing.
"""

import hashlib
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from verdict import run

OUT = "{OUT}"
RUNS = 3
PAUSE = 2.1  # s between the starts of two runs
LAST_WORDS = 400  # characters of what a command said that failed


def check(findings, command, pause=PAUSE):
    """Note every difference between the runs and every file that should not be there; returns a summary."""
    outputs = [Path(word.removeprefix(f"{OUT}/")) for word in command if word.startswith(f"{OUT}/")]
    if not outputs:
        raise ValueError(f"the command names no file in {OUT}")
    made = []
    with tempfile.TemporaryDirectory(prefix="same-") as folder:
        for number in range(RUNS):
            started = time.monotonic()
            made.append(run_once(findings, command, Path(folder) / str(number), number))
            time.sleep(max(0.0, pause - (time.monotonic() - started)) if number < RUNS - 1 else 0.0)
    first = made[0]
    for output in outputs:
        findings.need(str(output) in first, f"{output} was not written")
    for name in first:
        top = Path(name).parts[0]
        ours = any(  # a world file has the name of its picture and a w
            top in (output.name, f"{output.name}w") or top.startswith(f"{output.name}.") for output in outputs
        )
        findings.need(ours, f"{name} is left over")
    for number, files in enumerate(made[1:], 2):
        differing = sorted(name for name in first.keys() | files.keys() if first.get(name) != files.get(name))
        findings.need(not differing, f"run {number} differs from run 1 in {differing}")
    return f"{len(first)} files, the same in {RUNS} runs"


def run_once(findings, command, folder, number):
    """Name -> digest of every file that the command writes."""
    out, temporary = folder / "out", folder / "temporary"
    out.mkdir(parents=True)
    temporary.mkdir()
    ended = subprocess.run(
        [word.replace(OUT, str(out)) for word in command],
        env=os.environ | {"PYTHONHASHSEED": str(number), "TMPDIR": str(temporary)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    said = ended.stdout.decode(errors="replace")[-LAST_WORDS:]
    findings.need(ended.returncode == 0, f"run {number + 1} ended with {ended.returncode}: {said!r}")
    left = sorted(path.name for path in temporary.rglob("*"))
    findings.need(not left, f"run {number + 1} left {left} among the temporary files")
    files = [path for path in out.rglob("*") if path.is_file()]
    return {str(path.relative_to(out)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def main():
    return run(lambda findings: check(findings, sys.argv[1:]))


if __name__ == "__main__":
    sys.exit(main())
