"""Sensor sizes by make and model, from the cameras of the lensfun database (the extra `lens`)."""

from functools import cache

import lensfunpy

SAME_SENSOR = 1.02  # ratio of crop factors; a model whose entries differ by more is several cameras


@cache
def _database() -> lensfunpy.Database:
    # The one that comes with the package alone: what a machine has of its own would change what a photo gives there.
    return lensfunpy.Database(load_common=False)


def find_crop_factor(make: str, model: str) -> float | None:
    """Diagonal of the 35 mm frame over that of the sensor; None for a camera that is not known or not one."""
    if not make or not model:
        return None  # lensfun takes an empty name for any
    factors = [camera.crop_factor for camera in _database().find_cameras(make, model)]
    if not factors or max(factors) > SAME_SENSOR * min(factors):
        return None
    return float(factors[0])
