"""What the machine has and what photos need: how many workers a batch gets, and how much each may take."""

import os
import sys
from collections.abc import Iterable
from pathlib import Path

from PIL import Image

from linecad.batch.job import Limits

MIB = 2**20
# Resident at most, JSON, GLB and PNG: 310 MiB at 1.7 megapixels, 676 at 6.3 (castle 0003, 1,490 lines), 1,002 at 24.
# These leave room for scenes with more lines, and for STEP, whose library takes 300 MiB.
BASE_MB = 500
PER_MEGAPIXEL_MB = 60
SMALLEST_NEED_MB = 900  # also for tiny photos: the solver and the writers of formats
LARGEST_LOOKED_AT = 20  # photos, the largest files, whose sizes stand for all
KEPT_FREE = 0.1  # share of the memory that is left to other programs
SOLVER_TIMES, MORE_SECONDS = 3.0, 600.0  # of the solver's time limit; s for everything else
CGROUP = Path("/sys/fs/cgroup")
UNKNOWN_MB = 4096  # MiB taken to be free where the system does not say


def usual_workers(photos: Iterable[Path]) -> int:
    """As many as there are cores, but no more than fit into the free memory with photos like the largest of these."""
    return max(1, min(free_cores(), int(free_memory_mb() * (1 - KEPT_FREE) / need_mb(photos))))


def usual_limits(photos: Iterable[Path], workers: int, solver_seconds: float) -> Limits:
    """Limits that only a photo gone astray meets: its share of the free memory, and several times the solver's time."""
    share = int(free_memory_mb() * (1 - KEPT_FREE) / workers)
    return Limits(SOLVER_TIMES * solver_seconds + MORE_SECONDS, max(share, need_mb(photos)))


def need_mb(photos: Iterable[Path]) -> int:
    """MiB that the process of a photo may need, by the most pixels among the largest files."""
    largest = sorted(photos, key=_bytes_of, reverse=True)[:LARGEST_LOOKED_AT]
    megapixels = max(map(_megapixels, largest), default=0.0)
    return max(round(BASE_MB + PER_MEGAPIXEL_MB * megapixels), SMALLEST_NEED_MB)


def free_cores() -> int:
    """Cores that this process may use: its affinity, and the quota of its control group."""
    cores = len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1
    words = _read(CGROUP / "cpu.max").split()
    if len(words) == 2 and words[0].isdecimal() and words[1].isdecimal() and int(words[1]):
        cores = min(cores, max(int(words[0]) // int(words[1]), 1))
    return cores


def free_memory_mb() -> int:
    """MiB that can be had without swapping: of the system, and of the control group."""
    free = UNKNOWN_MB
    for line in _read(Path("/proc/meminfo")).splitlines():
        words = line.split()
        if words[:1] == ["MemAvailable:"]:
            free = int(words[1]) // 1024
    if sys.platform == "darwin":
        free = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // MIB // 2  # no call says what is free
    limit, used = _read(CGROUP / "memory.max").strip(), _read(CGROUP / "memory.current").strip()
    if limit.isdecimal() and used.isdecimal():
        free = min(free, (int(limit) - int(used)) // MIB)
    return max(free, 1)


def _bytes_of(photo: Path) -> int:
    try:
        return photo.stat().st_size
    except OSError:
        return 0


def _megapixels(photo: Path) -> float:
    """Of a photo, by its header; 0 where that cannot be read, for such a photo needs little."""
    try:
        with Image.open(photo) as image:
            return image.width * image.height / 1e6
    except Exception:  # Pillow's plugins raise whatever their parsing trips over; the worker says what is wrong
        return 0.0


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError):
        return ""
