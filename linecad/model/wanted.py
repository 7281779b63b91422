"""What of a scene is written, and at which scale: what a user asks of it once it is solved."""

import shlex
from dataclasses import dataclass

from linecad.confidence import keep_probable
from linecad.errors import ConfidenceError, ScaleError
from linecad.model.choice import Detail, keep_drawn
from linecad.model.scale import Known, set_scale
from linecad.scene import Scene

_SCALE_AGAIN = "--scale U,V:U2,V2=METRES"  # between two px of the photo: ids change where a scene is made anew


@dataclass(frozen=True)
class Wanted:
    """Plain values, so that they travel to other processes and have a hash."""

    known: Known | None = None  # a length that sets the scale
    confidence: float | None = None  # 0 to 1; lines whose depth is right with a smaller probability are left out
    detail: Detail = "all"  # which lines are written

    @property
    def is_whole(self) -> bool:
        """Whether nothing is left out of the scene."""
        return self.confidence is None and self.detail == "all"

    def of(self, scene: Scene) -> Scene:
        """The scene as it is wanted.

        Raises ScaleError for a length that the scene does not hold, or ConfidenceError where no line is as sure as was
        asked for.
        """
        if self.known is not None:
            scene = set_scale(scene, self.known)  # first, because the known line itself may be left out
        if self.confidence is not None:
            scene = keep_probable(scene, self.confidence)
        return keep_drawn(scene, self.detail)

    def again(self, error: Exception) -> list[str]:
        """The arguments that ask for the same, with a blank in place of what raised `error`."""
        known = [] if self.known is None else [shlex.join(self.known.arguments)]
        if isinstance(error, ScaleError):
            known = [_SCALE_AGAIN]
        confidence = [] if self.confidence is None else [f"--confidence {self.confidence:g}"]
        if isinstance(error, ConfidenceError):
            confidence = ["--confidence P"]
        detail = [] if self.detail == "all" else [f"--detail {self.detail}"]
        return [*known, *confidence, *detail]
