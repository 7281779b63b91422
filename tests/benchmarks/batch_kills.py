"""Kills the processes of `linecad batch` at random moments, and checks what every kill leaves behind.

    python tests/benchmarks/batch_kills.py --kills 200 --photos 20

Each round is a batch of the photos in a new folder. At a random moment, the process that gives out photos (or the one
who forks, or one who works on a photo) is ended by SIGKILL, and the batch is begun again, until all is done. After
every kill each file with a name of its own must be whole, and at the end of a round every photo must have exactly one
row that says that it is done, and exactly the files of a run that nobody disturbed. How long a kill waits follows from
what that run took, so that kills hit work on any machine. Linux only.
"""

import argparse
import collections
import itertools
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2

ROOT = Path(__file__).resolve().parents[2]
WIDTH = 320  # px of the photos
OPTIONS = ["--format", "json,obj", "--focal", "300", "--time-limit", "30", "--workers", "2", "--quiet"]
AT_WORK = 0.8  # share of the kills that wait until a photo was begun; the others come at any moment from the start
LONGEST_BATCH = 600.0  # s without an end: it hangs
FEWEST_KILLS = 1 / 3  # a round, on average; where fewer succeed, the waits are wrong
LOOK = 0.002  # s between two looks at the processes
KINDS = ["parent", "fork server", "worker", "worker"]


def make_photos(folder: Path, count: int) -> list[Path]:
    """So many small photos, of different contents."""
    folder.mkdir()
    photos = []
    for number in range(count):
        name = ("room", "street", "courtyard")[number % 3]
        photo = cv2.imread(str(ROOT / "samples" / f"{name}.jpg"))
        assert photo is not None
        width = WIDTH + 2 * number
        small = cv2.resize(photo, (width, width * photo.shape[0] // photo.shape[1]), interpolation=cv2.INTER_AREA)
        photos.append(folder / f"{name}{number:02d}.png")
        cv2.imwrite(str(photos[-1]), small)
    return photos


def start(photos: Path, output: Path) -> "subprocess.Popen[bytes]":
    """The batch in a process of its own."""
    command = [sys.executable, "-m", "linecad", "batch", str(photos), "-o", str(output), *OPTIONS]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


@dataclass(frozen=True)
class Calm:
    """A batch that nobody disturbed: what it made, and what it took on this machine."""

    contents: dict[str, bytes]
    loading_s: float  # until the first photo was begun
    photo_s: float  # a photo, on average


def run_calm(photos: list[Path], output: Path) -> Calm:
    """Convert the photos in peace."""
    began = time.monotonic()
    with start(photos[0].parent, output) as batch:
        try:
            while batch.poll() is None and not family(batch.pid)["worker"]:
                time.sleep(LOOK)
            loading = time.monotonic() - began
            said = batch.communicate(timeout=LONGEST_BATCH)[1].decode()
        finally:
            batch.kill()
    assert batch.returncode == 0, said
    expected = contents(output)
    check_done(output, photos, expected)
    return Calm(expected, loading, sum(row["seconds"] for row in rows(output)) / len(photos))


def family(parent: int) -> dict[str, list[int]]:
    """The processes of a batch by what they do."""
    forks = children(parent)
    return {"parent": [parent], "fork server": forks, "worker": [child for fork in forks for child in children(fork)]}


def children(process: int) -> list[int]:
    try:
        return [int(word) for word in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    except (FileNotFoundError, ProcessLookupError):
        return []


def rows(output: Path) -> list[dict[str, Any]]:
    """The lines of the record that are JSON."""
    found = []
    path = output / "batch.jsonl"
    for line in path.read_bytes().splitlines() if path.exists() else []:
        try:
            found.append(json.loads(line))
        except ValueError:
            continue
    return found


def contents(output: Path) -> dict[str, bytes]:
    """Every made file with a name of its own; AssertionError for an empty one."""
    found: dict[str, bytes] = {}
    for path in sorted(output.rglob("*")):
        name = path.relative_to(output).as_posix()
        if (
            not path.is_file()
            or path.name.startswith(".linecad-")
            or name in ("batch.jsonl", "batch.lock", "index.html")
        ):
            continue
        found[name] = path.read_bytes()
        assert found[name], f"{name} is empty"
    return found


def check_whole(output: Path, expected: dict[str, bytes]) -> None:
    """No file is half written: each is as in the run that nobody disturbed."""
    for name, content in contents(output).items():
        assert content == expected[name], f"{name} is not what it should be"


def check_done(output: Path, photos: list[Path], expected: dict[str, bytes]) -> None:
    """Every photo is done exactly once, with all its files, and nothing else lies there."""
    done = collections.Counter(row["photo"] for row in rows(output) if row["status"] == "done")
    assert done == dict.fromkeys(map(str, photos), 1), done
    assert contents(output) == expected
    assert not list(output.rglob(".linecad-*"))
    assert (output / "index.html").is_file()


def run_round(photos: list[Path], output: Path, calm: Calm, dice: random.Random, most: int) -> collections.Counter[str]:
    """One batch, disturbed at most so often until it is done; how many of each kind were killed."""
    killed: collections.Counter[str] = collections.Counter()
    while True:
        before = killed.total()
        with start(photos[0].parent, output) as batch:
            try:
                while killed.total() < most and (victim := wait_for_victim(batch, calm, dice)):
                    kind, process = victim
                    try:
                        os.kill(process, signal.SIGKILL)
                    except ProcessLookupError:  # it had just ended
                        continue
                    killed[kind] += 1
                    if kind == "parent":
                        break
                said = batch.communicate(timeout=LONGEST_BATCH)[1].decode()
            finally:
                batch.kill()
        code = batch.returncode
        assert code == 0 or (code in (1, -signal.SIGKILL) and killed.total() > before), f"ended with {code}: {said}"
        assert "Traceback" not in said, said
        check_whole(output, calm.contents)
        if code == 0:
            check_done(output, photos, calm.contents)
            return killed


def wait_for_victim(batch: "subprocess.Popen[bytes]", calm: Calm, dice: random.Random) -> tuple[str, int] | None:
    """Kind and number of a process of the batch at a random moment; None when the batch ended before."""
    kind = dice.choice(KINDS)
    at_work = dice.random() < AT_WORK
    while batch.poll() is None:
        while at_work and batch.poll() is None and not family(batch.pid)["worker"]:
            time.sleep(LOOK)
        moment = time.monotonic() + dice.uniform(0, calm.photo_s + (0 if at_work else calm.loading_s))
        while batch.poll() is None and time.monotonic() < moment:
            time.sleep(LOOK)
        victims = family(batch.pid)[kind]
        if batch.poll() is None and victims:
            return kind, dice.choice(victims)
    return None


def run_rounds(
    photos: list[Path], folder: Path, calm: Calm, dice: random.Random, kills: int
) -> Iterator[collections.Counter[str]]:
    """Rounds in new folders until so many processes were killed; after each, how many of each kind by then."""
    killed: collections.Counter[str] = collections.Counter()
    for number in itertools.count(1):
        killed += run_round(photos, folder / f"round{number}", calm, dice, kills - killed.total())
        yield killed.copy()
        if killed.total() >= kills:
            return
        assert killed.total() >= number * FEWEST_KILLS - 1, f"{number} rounds, and only {killed.total()} kills hit"


def main() -> None:
    """Run rounds until enough was killed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--photos", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    dice = random.Random(given.seed)
    killed: collections.Counter[str] = collections.Counter()
    with tempfile.TemporaryDirectory(prefix="linecad-kills-") as name:
        folder = Path(name)
        photos = make_photos(folder / "photos", given.photos)
        calm = run_calm(photos, folder / "calm")
        print(f"undisturbed: {calm.loading_s:.1f} s of loading, then {calm.photo_s:.2f} s a photo", flush=True)
        number, began = 0, time.monotonic()
        for number, killed in enumerate(run_rounds(photos, folder, calm, dice, given.kills), start=1):
            counts = ", ".join(f"{count} {kind}s" for kind, count in sorted(killed.items()))
            print(f"round {number} done, killed so far: {counts} ({time.monotonic() - began:.0f} s)", flush=True)
    print(f"{killed.total()} kills in {number} batches of {given.photos} photos: every photo done once, no file half")


if __name__ == "__main__":
    main()
