"""How a checker tells what it found: a line for each problem, then one line CHECK OK or CHECK FAILED.

Runs in the Pythons of FreeCAD and Blender too, so it needs nothing but the standard library of Python 3.10.
"""

import traceback
from collections.abc import Callable

OK, FAILED = "CHECK OK", "CHECK FAILED"  # how the last line starts, exit status 0 or 1
MOST_SHOWN = 40  # problems; a wrong unit puts every line of a file out of place


class Findings:
    """What a checker found wrong so far."""

    def __init__(self):
        self.problems: list[str] = []

    def need(self, holds: object, problem: str) -> bool:
        """Whether `holds` is true; where it is not, note the problem."""
        if not holds:
            self.problems.append(problem)
        return bool(holds)


def judge(check: Callable[[Findings], str]) -> list[str]:
    """The report of a checker, which notes problems and returns a summary; an exception is a problem too."""
    findings, summary = Findings(), ""
    try:
        summary = check(findings)
    except Exception as error:
        # Whatever it is: some programs that run a checker swallow exceptions and exit with 0.
        said = next(iter(str(error).strip().splitlines()), "")
        where = "".join(traceback.format_exception(error)[-2:-1]).strip().splitlines()
        findings.problems.append(f"{type(error).__name__}: {said} ({where[0].strip() if where else 'nowhere'})")
    report = [f"  - {problem}" for problem in findings.problems[:MOST_SHOWN]]
    if not findings.problems:
        return [*report, f"{OK} {summary}"]
    count = len(findings.problems)
    return [*report, f"{FAILED}: {count} problem{'s' * (count > 1)}; first: {findings.problems[0]} [{summary}]"]


def passed(report: list[str]) -> bool:
    """Whether the last line of a report says that all was right."""
    return bool(report) and report[-1].startswith(OK)


def run(check: Callable[[Findings], str]) -> int:
    """Print the report of a checker; returns its exit status."""
    report = judge(check)
    print("\n".join(report), flush=True)
    return 0 if passed(report) else 1
