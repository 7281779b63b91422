"""Progress for a person on stderr."""

import shutil
import sys
import time
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from solver.options import Progress


class ProgressDisplay:
    """One line that is written over on a terminal, a plain line a stage otherwise."""

    def __init__(self, is_quiet: bool, is_verbose: bool) -> None:
        self.quiet, self.verbose = is_quiet, is_verbose
        self.live = sys.stderr.isatty() and not self.quiet
        self.stage_started = time.monotonic()
        self.current = ""

    def stage(self, text: str) -> None:
        """A new stage begins."""
        self._finish_stage()
        self.current, self.stage_started = text, time.monotonic()
        if self.live:
            self._over(f"{text} ...")
        elif not self.quiet and not self.verbose:
            print(text, file=sys.stderr, flush=True)

    def note(self, text: str) -> None:
        """What the user should know of the result, in any loudness."""
        if self.live:
            self._over("")
        print(f"linecad: {text}", file=sys.stderr, flush=True)

    def progress(self, at: "Progress") -> None:
        """The solver has come further."""
        if self.live:
            self._over(
                f"{self.current} ... {at.seconds:.1f} s, best {at.objective:.1f}, bound {at.bound:.1f}, "
                f"gap {at.gap:.2%} (Ctrl-C keeps the best)"
            )

    def line(self, text: str, is_important: bool) -> None:
        """One of many photos is over; on a terminal only what is important stays above the bar."""
        if self.live:
            if is_important or self.verbose:
                print(f"\r\033[K{text}", file=sys.stderr, flush=True)
        elif not self.quiet:
            print(text, file=sys.stderr, flush=True)

    def bar(self, text: str) -> None:
        """How far many photos are, on a terminal alone, cut to its width."""
        if self.live:
            self._over(text[: shutil.get_terminal_size().columns - 1])

    def finish(self) -> None:
        """No stage any more; the next line on a terminal is a clean one."""
        self._finish_stage()
        self.current = ""
        if self.live:
            self._over("")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception: object) -> None:
        """Nothing more to show; an error's line begins on a clean one."""
        self.finish()

    def _finish_stage(self) -> None:
        if self.verbose and self.current:
            line = f"{time.monotonic() - self.stage_started:7.2f} s  {self.current}"
            print(f"\r\033[K{line}" if self.live else line, file=sys.stderr, flush=True)

    def _over(self, text: str) -> None:
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
