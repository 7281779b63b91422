"""Looks: what a photo shows beside its lines and below its walls, looked at once for all ways to part the lines."""

from functools import cached_property

from linecad.ties.colours import Seen, seen_beside
from linecad.ties.feet import FootReader
from linecad.ties.setting import Setting


class Looks:
    """Of the photo and the lines of a setting, whatever bodies these are in; each look when it is asked for."""

    def __init__(self, setting: Setting) -> None:
        self._setting = setting

    @cached_property
    def beside(self) -> Seen | None:
        """What stands beside each line, as `linecad.ties.colours.seen_beside`."""
        return seen_beside(self._setting)

    @cached_property
    def feet(self) -> FootReader:
        """Of the feet of walls."""
        return FootReader(self._setting)
