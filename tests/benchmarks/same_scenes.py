"""What differs between scene files of the same photos: `python tests/benchmarks/same_scenes.py BEFORE AFTER`.

Two folders of scene files by the same names, written before and after a change of the code. Counts, key by key, the
records that differ; the seconds of the solver, which older files have, do not count. With --tolerance, numbers may
differ by so much, relative.
"""

import argparse
import json
from collections import Counter
from pathlib import Path
from typing import Any

RECORDS = ("lines", "intersections", "planes")


def same(one: Any, other: Any, tolerance: float) -> bool:
    """Whether two values of JSON are the same, but for numbers within the tolerance."""
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) <= tolerance * max(1.0, abs(one))
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(same(a, b, tolerance) for a, b in zip(one, other, strict=True))
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key], tolerance) for key in one)
    return bool(one == other)


def without_seconds(solve: Any) -> Any:
    return {name: value for name, value in solve.items() if name != "seconds"} if isinstance(solve, dict) else solve


def compare(before: dict[str, Any], after: dict[str, Any], tolerance: float) -> Counter[str]:
    """How many records differ, by the place of the key."""
    found: Counter[str] = Counter()
    for key in sorted(before.keys() | after.keys()):
        one, other = before.get(key), after.get(key)
        if key == "solve":
            one, other = (without_seconds(solve) for solve in (one, other))
        if key in RECORDS and one is not None and other is not None and len(one) == len(other):
            for a, b in zip(one, other, strict=True):
                for name in sorted(a.keys() | b.keys()):
                    if name not in a or name not in b:
                        found[f"{key}.{name} {'is new' if name in b else 'is gone'}"] += 1
                    elif not same(a[name], b[name], tolerance):
                        found[f"{key}.{name}: {a[name]} -> {b[name]}" if name == "confidence" else f"{key}.{name}"] += 1
        elif not same(one, other, tolerance):
            found[key] += 1
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--tolerance", type=float, default=0.0)
    parser.add_argument("--each", action="store_true", help="photo by photo")
    chosen = parser.parse_args()
    total: Counter[str] = Counter()
    photos: Counter[str] = Counter()
    files = [path for path in sorted(chosen.before.glob("*.json")) if (chosen.after / path.name).is_file()]
    for path in files:
        texts = [folder.joinpath(path.name).read_text(encoding="utf-8") for folder in (chosen.before, chosen.after)]
        before, after = map(json.loads, texts)
        found = compare(before, after, chosen.tolerance)
        total.update(found)
        photos.update(found.keys())
        if chosen.each:
            print(path.stem, dict(found))
    print(f"{len(files)} scenes")
    for key, count in sorted(total.items()):
        print(f"  {key}: {count} in {photos[key]} scenes")


if __name__ == "__main__":
    main()
