"""How a long call tells what it does at the moment: a function that takes each stage in words."""

from collections.abc import Callable

StageReport = Callable[[str], None]


def silent(_stage: str) -> None:
    """Report nothing."""
