"""How many threads a process computes with: the variables that libraries read before they are loaded."""

import os

THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)


def thread_count() -> int:
    """As many as this process may use: OMP_NUM_THREADS where that is set, as by runs of many photos, else the cores."""
    asked = os.environ.get(THREADS[0], "")
    return max(1, int(asked)) if asked.isdigit() else os.cpu_count() or 1
