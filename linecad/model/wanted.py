"""What of a scene is written, and at which scale: what a user asks of it once it is solved."""

import shlex
from dataclasses import dataclass

from linecad.confidence import keep_probable
from linecad.errors import ConfidenceError, GroupError, ScaleError
from linecad.model.choice import Detail, keep_drawn
from linecad.model.groups import Groups, choose_main, keep_main
from linecad.model.scale import Known, set_scale
from linecad.scene import Scene

_SCALE_AGAIN = "--scale U,V:U2,V2=METRES"  # between two px of the photo: ids change where a scene is made anew


@dataclass(frozen=True)
class Wanted:
    """Plain values, so that they travel to other processes and have a hash."""

    main: tuple[float, float] | None = None  # px: what stands there is component 0
    known: Known | None = None  # a length that sets the scale
    groups: Groups = "all"  # which components are written
    confidence: float | None = None  # 0 to 1; lines whose depth is right with a smaller probability are left out
    detail: Detail = "all"  # which lines are written

    @property
    def is_whole(self) -> bool:
        """Whether nothing is left out of the scene."""
        return self.groups == "all" and self.confidence is None and self.detail == "all"

    def of(self, scene: Scene) -> Scene:
        """The scene as it is wanted.

        Raises GroupError for a place where nothing stands, ScaleError for a length that the scene does not hold, or
        ConfidenceError where no line is as sure as was asked for.
        """
        if self.main is not None:
            scene = choose_main(scene, self.main)
        if self.known is not None:
            scene = set_scale(scene, self.known)  # first, because the known line itself may be left out
        if self.groups == "main":
            scene = keep_main(scene)
        if self.confidence is not None:
            scene = keep_probable(scene, self.confidence)
        return keep_drawn(scene, self.detail)

    def again(self, error: Exception) -> list[str]:
        """The arguments that ask for the same, with a blank in place of what raised `error`."""
        main = [] if self.main is None else [f"--main {self.main[0]:g},{self.main[1]:g}"]
        if isinstance(error, GroupError):
            main = ["--main U,V"]
        known = [] if self.known is None else [shlex.join(self.known.arguments)]
        if isinstance(error, ScaleError):
            known = [_SCALE_AGAIN]
        confidence = [] if self.confidence is None else [f"--confidence {self.confidence:g}"]
        if isinstance(error, ConfidenceError):
            confidence = ["--confidence P"]
        groups = [] if self.groups == "all" else [f"--groups {self.groups}"]
        detail = [] if self.detail == "all" else [f"--detail {self.detail}"]
        return [*main, *known, *groups, *confidence, *detail]
