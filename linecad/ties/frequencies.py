"""How often values of one kind, sizes or heights, occur in two bodies: alike at one ratio of the bodies' scales.

Two bodies are compared at all ratios at once, by the correlation of how often each log value occurs in them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linecad.arrays import Float

STEP = 0.004  # log value, between two samples of a frequency
LARGEST = 4.0  # log value over the body's median depth, in magnitude
WIDEST = 1.2  # log ratio beyond which no scale is looked for
SAME = 0.012  # log ratio within which a correlation counts for a ratio: bodies are not known better
APART, BESIDE = 0.03, 0.3  # log ratio from a ratio on, and up to which, others are its rivals

Spectrum = NDArray[np.complex128]

_SAMPLES = round(2 * LARGEST / STEP)


@dataclass(frozen=True, eq=False)
class Frequencies:
    """How often each value occurs in one body."""

    middle: float  # log of the body's median depth, which values are counted from
    spectra: tuple[Spectrum | None, ...]  # of the frequencies of each kind of value; None where these tell nothing


class Correlation:
    """The frequencies of two bodies against each other, at log ratios of the scale of the first to the second's."""

    def __init__(self, first: Frequencies, second: Frequencies) -> None:
        between = second.middle - first.middle  # the log ratio at which equal frequencies would be one upon the other
        most = round(WIDEST / STEP)
        shift = np.arange(-most, most + 1) - round(between / STEP)
        shift = shift[np.abs(shift) < _SAMPLES]
        self._places = shift * STEP + between
        pairs = [
            np.conj(own) * other
            for own, other in zip(first.spectra, second.spectra, strict=True)
            if own is not None and other is not None
        ]
        total = np.fft.irfft(sum(pairs), 2 * _SAMPLES)[shift] if pairs else np.zeros(len(shift))
        spread = float(total.std()) if len(total) else 0.0
        self._excess = total / spread if spread > 0 else total

    def at(self, log_ratio: float) -> float:
        """Correlation at a ratio, in standard deviations of that at all ratios; 0 where nothing tells."""
        return self._largest(np.abs(self._places - log_ratio) <= SAME)

    def lead(self, log_ratio: float) -> float:
        """By how much the correlation at a ratio exceeds that at its rivals; 0 where nothing tells."""
        apart = np.abs(self._places - log_ratio)
        return self.at(log_ratio) - self._largest((apart > APART) & (apart < BESIDE))

    def _largest(self, chosen: NDArray[np.bool_]) -> float:
        return float(self._excess[chosen].max()) if chosen.any() else 0.0


def spectrum(
    values: Float, alike: float, around: float, scaled: Callable[[Float], Float] | None = None
) -> Spectrum | None:
    """Of the frequency of log values less its mean over `around` to both sides, of unit energy.

    A value is known within the standard deviation `alike`; frequencies are `scaled` first. None where the frequency is
    the same all over.
    """
    place = np.floor((values + LARGEST) / STEP).astype(np.int64)
    count = np.bincount(place[(place >= 0) & (place < _SAMPLES)], minlength=_SAMPLES).astype(np.float64)
    reach = int(np.ceil(3 * alike / STEP))
    known = np.exp(-0.5 * (np.arange(-reach, reach + 1) * STEP / alike) ** 2)
    frequency = np.convolve(count, known, "same")
    if scaled is not None:
        frequency = scaled(frequency)
    wide = 2 * round(around / STEP) + 1
    frequency = frequency - np.convolve(frequency, np.full(wide, 1 / wide), "same")
    energy = float(np.linalg.norm(frequency))
    return np.fft.rfft(frequency / energy, 2 * _SAMPLES) if energy > 0 else None
