"""How a made scene is lit: the sun, a sky, and in rooms a lamp behind the camera."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from linecad.arrays import Float

ELEVATION = (0.45, 1.05)  # rad, of the sun
SUN = (4.6, 4.2, 3.6)  # irradiance of full sun where the sky's radiance is about 1
LAMP = (2.0, 1.9, 1.75)  # radiance of the lamp of a room
SKY_IN_ROOMS = 0.4  # of the sky's radiance; curtains keep the rest out


@dataclass(frozen=True, eq=False)
class Light:
    """Everything that shines."""

    towards: Float  # (3,) unit vector along which sunlight travels
    sun: Float  # (3,) irradiance across the beam
    sky_seed: int
    lamp: tuple[Float, Float, Float] | None = None  # a corner and two sides of a rectangle, m, building frame


def draw_light(rng: Generator, is_room: bool) -> Light:
    """The light of a scene; one day in four is overcast.

    The sun stands behind the camera more often than before it. It does not shine into rooms, for the noise.
    """
    azimuth = float(rng.uniform(-1.9, 1.9))
    elevation = float(rng.uniform(*ELEVATION))
    towards = np.array([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), -np.sin(elevation)])
    strength = float(rng.uniform(0.7, 1.0)) if rng.random() < 0.75 else 0.08
    # As large as the wall behind the camera, which never sees it: a small lamp would light a spot of the wall near it,
    # and small bright spots make noise.
    lamp = (np.array([-2.1, -1.93, 0.4]), np.array([4.2, 0.0, 0.0]), np.array([0.0, 0.0, 2.1])) if is_room else None
    sun = (0.0 if is_room else strength) * np.array(SUN)
    return Light(towards, sun, int(rng.integers(2**31)), lamp)
