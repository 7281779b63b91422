"""Photos a minute of `linecad batch` with one and two workers, its memory, and whether its files are those of convert.

    python tests/benchmarks/batch_speed.py FOLDER --photos 40 --focal 675

Runs with one and two workers alternate, 1 2 2 1, so that a neighbour on the machine harms both alike; the ratio is only
worth something on cores that nobody else uses, which the load printed beside it tells. Files are compared for photos
whose solver ended before its limit.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ORDER = (1, 2, 2, 1)  # workers of the runs


def run(arguments: list[str]) -> float:
    """The seconds that a command of linecad takes."""
    began = time.monotonic()
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "linecad", *arguments, "--quiet"]
    subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=False)
    return time.monotonic() - began


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--photos", type=int, default=40)
    parser.add_argument("--focal", default="675", help="px")
    parser.add_argument("--time-limit", default="20", help="s for the solver")
    parser.add_argument("--compared", type=int, default=10, help="photos that are also converted one by one")
    given = parser.parse_args()
    photos = sorted(map(str, given.folder.glob("*.jpg")))[: given.photos]
    options = ["--focal", given.focal, "--time-limit", given.time_limit]
    seconds: dict[int, list[float]] = {1: [], 2: []}
    with tempfile.TemporaryDirectory(prefix="linecad-speed-") as name:
        for number, workers in enumerate(ORDER):
            output = Path(name) / str(number)
            took = run(
                ["batch", *photos, "-o", str(output), "--workers", str(workers), "--format", "json,dxf", *options]
            )
            seconds[workers].append(took)
            rows = [json.loads(line) for line in (output / "batch.jsonl").read_text().splitlines()]
            memory = [row["memory_mb"] for row in rows]
            quarter = max(len(rows) // 4, 1)
            print(
                f"{workers} workers: {60 * len(rows) / took:.1f} photos a minute ({took:.0f} s), "
                f"{sum(row['status'] == 'done' for row in rows)} of {len(photos)} done; processor "
                f"{statistics.mean(row['cpu_seconds'] for row in rows):.2f} s a photo; memory of a process, mean "
                f"of the first quarter {statistics.mean(memory[:quarter]):.0f} MiB, of the last "
                f"{statistics.mean(memory[-quarter:]):.0f}; load {os.getloadavg()[0]:.1f}",
                flush=True,
            )
        print(f"2 workers are {sum(seconds[1]) / sum(seconds[2]):.2f} times as fast as 1")
        proven = [row["name"] for row in rows if row.get("solver") == "optimal"][: given.compared]
        same = 0
        for photo in photos:
            stem = Path(photo).stem
            if stem not in proven:
                continue
            files = [Path(name) / f"{stem}{suffix}" for suffix in (".json", ".dxf")]
            run(["convert", photo, *[word for file in files for word in ("-o", str(file))], *options])
            same += all(file.read_bytes() == (output / file.name).read_bytes() for file in files)
        print(f"{same} of {len(proven)} photos have the files of convert, byte for byte")


if __name__ == "__main__":
    main()
