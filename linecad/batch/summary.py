"""What a batch shows to people: a bar or lines while it runs, and a table at its end."""

import statistics
from pathlib import Path

from linecad.batch.job import STATUSES
from linecad.batch.page import figures_text
from linecad.batch.record import Row
from linecad.batch.run import Progress, Result

BAR = 24  # characters
LISTED = 20  # failures that the summary names
NAME_WIDTH = 40  # characters


def bar(progress: Progress, seconds: float) -> str:
    """One line: bar, counts, rate, time left. `seconds` is the time since the start."""
    full = BAR * progress.over // max(progress.total, 1)
    parts = [f"[{'#' * full}{'.' * (BAR - full)}] {progress.over} of {progress.total}"]
    if progress.skipped:
        parts.append(f"{progress.skipped} were done")
    if progress.failed:
        parts.append(f"{progress.failed} failed")
    if progress.running:
        parts.append(f"{progress.running} running")
    worked = progress.done + progress.failed
    if worked and seconds > 0:
        rate = worked / seconds
        left = (progress.total - progress.over) / rate
        parts += [f"{60 * rate:.1f} a minute", f"{_duration(left)} left"]
    return ", ".join(parts)


def line(progress: Progress, row: Row) -> str:
    """One line about a photo that has just ended."""
    outcome = row.outcome
    what = outcome.error if outcome.figures is None else figures_text(outcome.figures)
    return f"{progress.over} of {progress.total}  {shown(row)}: {outcome.status}, {what} ({outcome.seconds:.1f} s)"


def table(result: Result) -> str:
    """The summary: how many of each status, with their medians, and the failures by name."""
    lines = [f"{'status':14}{'photos':>8}{'s':>10}{'cpu s':>10}{'MiB':>8}{'lines':>8}{'gap %':>8}"]
    for status in STATUSES:
        rows = [row for row in result.rows if row.outcome.status == status]
        if not rows:
            continue
        outcomes = [row.outcome for row in rows]
        figures = [outcome.figures for outcome in outcomes if outcome.figures]
        gaps = [100 * each.gap for each in figures if each.gap is not None]
        lines.append(
            f"{status:14}{len(rows):8}{_median([o.seconds for o in outcomes], 1):>10}"
            f"{_median([o.cpu_seconds for o in outcomes], 1):>10}{_median([o.memory_mb for o in outcomes], 0):>8}"
            f"{_median([each.lines for each in figures], 0):>8}{_median(gaps, 2):>8}"
        )
    failed = [row for row in result.rows if row.outcome.status != "done"]
    lines += [f"{shown(row)}: {row.outcome.status}: {row.outcome.error}" for row in failed[:LISTED]]
    if len(failed) > LISTED:
        lines.append(f"and {len(failed) - LISTED} more, in the page and the record")
    progress = result.progress
    lines.append(
        f"{progress.done} photos converted, {progress.skipped} were done before, {progress.failed} failed, "
        f"in {_duration(result.seconds)}"
    )
    if progress.damaged:
        lines.append(f"{progress.damaged} lines of the record were cut off or damaged and count for nothing")
    return "\n".join(lines)


def shown(row: Row) -> str:
    """A photo's name on one line, printable whatever it is."""
    name = " ".join(Path(row.photo).name.encode("utf-8", "replace").decode().split())
    printable = "".join(letter if letter.isprintable() else "?" for letter in name)
    return printable if len(printable) <= NAME_WIDTH else f"{printable[: NAME_WIDTH - 3]}..."


def _median(numbers: list[float] | list[int], digits: int) -> str:
    return f"{statistics.median(numbers):.{digits}f}" if numbers else "-"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"
