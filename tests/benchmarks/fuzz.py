"""Coverage-guided fuzzing of everything that reads files from outside, by atheris (`pip install atheris`).

    python tests/benchmarks/fuzz.py TARGET --seconds 300 --corpus FOLDER

Inputs that reach something new are added to FOLDER; one that breaks the reader is written to FOLDER-found and ends the
run. JSON is mutated by its values as well as by its bytes, with numbers, lengths and keys that readers trip over.
"""

import argparse
import copy
import hashlib
import json
import random
import sys
import time
import warnings
from pathlib import Path
from types import FrameType
from typing import Any

import atheris

sys.path[:0] = [str(Path(__file__).resolve().parents[2]), str(Path(__file__).resolve().parents[1] / "fuzz")]
with atheris.instrument_imports(include=["linecad", "PIL"]):
    from targets import TARGETS, Target, folder_in_memory

HOSTILE: list[Any] = [
    0, -0.0, -1, 1, 2, 3.0, 1e308, -1e308, 5e-324, 1e12, 1.0000001e12, 2**31, 2**53, 2**64, -(2**63), 10**30, 0.5,
    None, True, False, "", "x", "\ud800", "../../x", [], [[]], {}, [0], {"a": 0},
]  # fmt: skip
BY_VALUE = 0.7  # share of the mutations of JSON that change values and not bytes
LARGEST_GROWTH = 50  # copies of one element


def mutate_values(data: bytes, largest: int, seed: int) -> bytes:
    """JSON with one to three of its values changed; or bytes changed by libFuzzer."""
    dice = random.Random(seed)
    try:
        document = json.loads(data)
    except (ValueError, RecursionError):
        document = None
    if document is None or dice.random() > BY_VALUE:
        return bytes(atheris.Mutate(data, largest))
    holder = [document]
    for _ in range(dice.randint(1, 3)):
        place, key = dice.choice(list(places(holder)))
        change(place, key, dice)
    text = json.dumps(holder[0] if holder else None)
    for word in ("NaN", "Infinity", "1e999"):
        if dice.random() < 0.01:
            text = text.replace("0.0", word, 1)
    return text.encode("utf-8", "surrogatepass")[:largest]


def places(value: object) -> list[tuple[Any, Any]]:
    """Every list or object in nested ones, with each of its indices or keys."""
    found: list[tuple[Any, Any]] = []
    waiting: list[Any] = [value]
    while waiting:
        at = waiting.pop()
        keys = range(len(at)) if isinstance(at, list) else list(at) if isinstance(at, dict) else []
        for key in keys:
            found.append((at, key))
            waiting.append(at[key])
    return found


def change(place: Any, key: Any, dice: random.Random) -> None:
    """One value, that of a key in a list or object, replaced, removed, doubled or exchanged."""
    how = dice.randrange(5)
    if how == 0 and len(place) > 1:
        del place[key]
    elif how == 1 and isinstance(place, list):
        place.extend(copy.deepcopy(place[key]) for _ in range(dice.randint(1, LARGEST_GROWTH)))
    elif how == 2 and isinstance(place[key], int | float):
        place[key] = place[key] * dice.choice([-1, 2, 0.5, 1e6, 1e300, 1 + 1e-8]) + dice.choice([0, 1, 1e-9])
    elif how == 3:
        place[key] = copy.deepcopy(place[dice.choice(list(place) if isinstance(place, dict) else range(len(place)))])
    else:
        place[key] = copy.deepcopy(dice.choice(HOSTILE))


def keep_few(target: Target, corpus: Path, kept: Path, folder: Path) -> None:
    """Copy the inputs, smallest first, that reach a step from line to line that no smaller one reaches."""
    known: set[tuple[str, int, int]] = set()
    reached: set[tuple[str, int, int]] = set()
    last: dict[object, int] = {}

    def trace(frame: FrameType, event: str, _argument: object) -> Any:
        name = frame.f_code.co_filename
        if "linecad" not in name and "PIL" not in name:
            return None
        if event == "line":
            reached.add((name, last.get(frame, 0), frame.f_lineno))
            last[frame] = frame.f_lineno
        elif event == "return":
            last.pop(frame, None)
        return trace

    kept.mkdir(parents=True, exist_ok=True)
    for path in sorted(corpus.iterdir(), key=lambda path: (path.stat().st_size, path.name)):
        data = path.read_bytes()
        reached.clear()
        sys.settrace(trace)
        try:
            target.read(data, folder)
        finally:
            sys.settrace(None)
        if not reached <= known:
            known |= reached
            (kept / hashlib.sha256(data).hexdigest()[:12]).write_bytes(data)


def main() -> None:
    """Run one target for a time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("target", choices=sorted(TARGETS))
    parser.add_argument("--seconds", type=int, default=300)
    parser.add_argument("--corpus", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--keep-in", type=Path, metavar="FOLDER", help="instead: copy there the few that reach all")
    parser.add_argument("--seed", type=int, default=int(time.time()))
    given = parser.parse_args()
    warnings.simplefilter("error", RuntimeWarning)  # NumPy's overflows are findings too
    target = TARGETS[given.target]
    given.corpus.mkdir(parents=True, exist_ok=True)
    found = given.corpus.with_name(given.corpus.name + "-found")
    found.mkdir(exist_ok=True)
    for number, seed in enumerate(target.seeds()):
        (given.corpus / f"seed-{number:02d}").write_bytes(seed)
    with folder_in_memory() as memory:
        folder = Path(memory)
        options = [
            sys.argv[0], str(given.corpus), f"-max_total_time={given.seconds}", f"-max_len={target.largest}",
            "-timeout=20", "-rss_limit_mb=3000", f"-artifact_prefix={found}/", f"-seed={given.seed % 2**31 or 1}",
            "-print_final_stats=1", "-verbosity=1", "-reload=0",
        ]  # fmt: skip
        if given.keep_in is not None:
            keep_few(target, given.corpus, given.keep_in, folder)
            return
        mutator = {"custom_mutator": mutate_values} if target.is_json else {}
        atheris.Setup(options, lambda data: target.read(bytes(data), folder), **mutator)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
