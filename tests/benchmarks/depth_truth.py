"""True depth of photos as a network would see it, and simulated maps made of it; used by ties.py and depth_maps.py."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2
from scipy.spatial import cKDTree

from linecad.arrays import Float, Int
from linecad.dataset.depth_maps import MapKind, corrupted_depth, map_pixels
from linecad.dataset.truth import NOTHING
from linecad.dataset.walls import walls_of_quads
from linecad.depth.depth_map import DepthMap
from linecad.depth.validity import valid_depths
from linecad.evaluation.references import Points, Reference
from linecad.geometry import homogeneous
from linecad.scene import Camera

FARTHEST = 0.06  # of the photo's width from a surveyed point, beyond which nothing is known
WALLS = 30  # that surveyed points are parted into, by where they are


@dataclass(frozen=True, eq=False)
class TrueDepth:
    """What a perfect map of a network's size holds."""

    depth: Float  # (h, w) z, NaN where it is not known
    walls: Int  # (h, w) NOTHING for the sky, and where nothing is known
    size: tuple[int, int]  # width and height of the photo, px

    def simulated(self, width: float | None, seed: int, kind: MapKind = "z", is_told: bool = True) -> DepthMap:
        """A map on the photo's pixels with errors of that Cauchy width; None: without any."""
        if width is None:
            values = np.where(np.isfinite(self.depth), self.depth, 0.0).astype(np.float32)
        else:
            drawn = corrupted_depth(self.depth, self.walls, width, np.random.default_rng(seed), kind)
            values = valid_depths(np.nan_to_num(drawn), None)[0]
        return self.of_values(values, kind if is_told else None)

    def of_values(self, values: NDArray[np.float32], kind: MapKind | None) -> DepthMap:
        """Any values (h, w) as a map of the photo."""
        large = np.asarray(cv2.resize(values, self.size, interpolation=cv2.INTER_NEAREST), np.float32)
        return DepthMap("simulated", large, large > 0, kind)


def true_depth(reference: Reference, camera: Camera) -> TrueDepth:
    """Of a made photo what each pixel shows; of a real one the depth of the nearest surveyed point."""
    rows, columns = map_pixels(camera.height, camera.width)
    x, y = np.meshgrid(columns, rows)
    pixels = np.column_stack([x.ravel(), y.ravel()]).astype(np.float64)
    size = (camera.width, camera.height)
    if reference.truth is not None:
        truth = reference.truth
        quads = truth.ids[np.ix_(rows, columns)]
        depth = truth.quad_depth(pixels, quads.ravel()).reshape(quads.shape)
        return TrueDepth(depth, np.append(walls_of_quads(truth.quads, truth.body), NOTHING)[quads], size)
    surveyed = reference.dense or reference.edges
    assert surveyed is not None
    off, nearest = cKDTree(surveyed.pixels).query(pixels)
    is_known = (off < FARTHEST * camera.width).reshape(x.shape)
    depth = np.where(is_known, surveyed.depth[nearest].reshape(x.shape), np.nan)
    walls = _clusters(surveyed, camera)[nearest].reshape(x.shape)
    return TrueDepth(depth, np.where(is_known, walls, NOTHING), size)


def _clusters(surveyed: Points, camera: Camera) -> Int:
    """Which of WALLS parts of space each point (M,) is in."""
    points = homogeneous(surveyed.pixels) @ np.linalg.inv(camera.matrix).T * surveyed.depth[:, None]
    labels: Int = kmeans2(points / points.std(), WALLS, seed=1, minit="++")[1].astype(np.int64)
    return labels
