"""The depths of a scene measured in two scopes alike: everything that is in its file, and component 0 alone."""

from dataclasses import dataclass

import numpy as np

from linecad.arrays import Bool, Float
from linecad.evaluation.calibration import ConfidenceScore, Tenth, find_tenths, score_confidence
from linecad.evaluation.depth import DepthScore, dense_depths, depths_of, nearest_lines, score, score_depth
from linecad.evaluation.references import Points
from linecad.scene import Scene

RIGHT = 0.05  # relative error of the depth; within it is what the probability of a line speaks of


@dataclass(frozen=True)
class ScopeScore:
    """What is measured in one scope."""

    lines: DepthScore
    dense: DepthScore | None  # lines and faces; None where depths are known on edges alone
    confidence: ConfidenceScore | None  # None for a scene without probabilities, or whose component 0 has no scale


@dataclass(frozen=True)
class SceneScore:
    """The depths of a scene in both scopes."""

    everything: ScopeScore  # lines, and lines with faces, each by the median ratio of all points that got a depth
    component_0: ScopeScore  # both by the median ratio of its lines
    calibration: tuple[Tenth, ...] | None  # of all lines, by the scale of component 0; None as for `confidence`

    @property
    def face_scale(self) -> float | None:
        """Found over true depth of everything, faces too where depths are known off the edges; None: not known."""
        return (self.everything.dense or self.everything.lines).scale


def score_scene(scene: Scene, edges: Points, dense: Points | None) -> SceneScore:
    """Score a scene against points of known depth on edges and, where there are such, anywhere."""
    own = scene.lines.component == 0
    largest = score_depth(scene, edges.pixels, edges.depth, own)
    everything = ScopeScore(
        score_depth(scene, edges.pixels, edges.depth),
        None if dense is None else score(dense_depths(scene, dense.pixels), dense.depth),
        _confidence(scene, edges, np.ones(len(own), bool), largest.scale),
    )
    component_0 = ScopeScore(
        largest,
        None if dense is None else _dense_by_lines(scene, dense, own, largest.scale),
        _confidence(scene, edges, own, largest.scale),
    )
    judged = judge(scene, edges, np.ones(len(own), bool), largest.scale)
    return SceneScore(everything, component_0, None if judged is None else find_tenths(*judged))


def judge(scene: Scene, edges: Points, lines: Bool, scale: float | None) -> tuple[Float, Bool] | None:
    """The probability (P,) stated for each point to which `lines` (N,) give a depth, and whether it is right (P,).

    Right is within RIGHT by `scale`, found over true depth of component 0. None for a scene without probabilities, or
    without a scale.
    """
    if len(scene.lines.probability) == 0 or scale is None:
        return None
    which = nearest_lines(scene, edges.pixels, lines)
    depth = depths_of(scene, edges.pixels, which)
    has = np.isfinite(depth) & (depth > 0)
    error = np.abs(depth[has] / edges.depth[has] / scale - 1)
    return np.asarray(scene.lines.probability)[which[has]], error < RIGHT


def _confidence(scene: Scene, edges: Points, lines: Bool, scale: float | None) -> ConfidenceScore | None:
    judged = judge(scene, edges, lines, scale)
    return None if judged is None else score_confidence(*judged, len(edges.depth))


def _dense_by_lines(scene: Scene, dense: Points, lines: Bool, scale: float | None) -> DepthScore:
    """Lines and faces by the scale of the lines; nothing counts where that is not known."""
    depth = dense_depths(scene, dense.pixels, lines)
    return score(depth if scale is not None else np.full(len(depth), np.nan), dense.depth, scale)
