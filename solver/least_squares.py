"""Linear least squares whose solution is not unique."""

import numpy as np
import scipy.linalg

from linecad.arrays import Float


def shortest_solution(rows: Float, right: Float) -> Float:
    """The shortest x (C,) of all for which rows (R, C) @ x is nearest to right (R,).

    By a complete orthogonal factorisation (LAPACK's gelsy): NumPy's way is an iteration, which gave up on rows that
    a photo asked for, of half the rank.
    """
    rcond = np.finfo(np.float64).eps * max(rows.shape)
    return np.asarray(scipy.linalg.lstsq(rows, right, cond=rcond, lapack_driver="gelsy")[0], np.float64)
