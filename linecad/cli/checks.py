"""What can be known to fail is refused before the long work starts."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from linecad.errors import OutputError


def check_outputs(outputs: Sequence[Path], inputs: Iterable[Path | None]) -> None:
    """Raise OutputError where an output cannot be written, is named twice, or would overwrite one of the inputs."""
    from linecad.io.files import check_output

    for path in outputs:
        check_output(path)
    check_kept(outputs, inputs)
    if len({path.resolve() for path in outputs}) < len(outputs):
        raise OutputError("the same output was named twice; name each once")


def check_kept(outputs: Iterable[Path], inputs: Iterable[Path | None]) -> None:
    """Raise OutputError where writing an output would overwrite an input."""
    kept = [path for path in inputs if path is not None and path.exists()]
    for path in outputs:
        for given in kept:
            if path.exists() and path.samefile(given):
                raise OutputError(f"{path} is an input too and would be lost; choose another name")


def check_some(outputs: Sequence[Path]) -> None:
    """Raise OutputError where no output was named."""
    if not outputs:
        raise OutputError("no output was named; give one or more, such as -o scene.json -o scene.step")
