"""The usual sizes of paper and scales: nothing else, so that the table of formats costs nothing to load."""

SIZES = {"A4": (297, 210), "A3": (420, 297), "A2": (594, 420), "A1": (841, 594), "A0": (1189, 841)}  # mm, landscape
# 1:N of ISO 5455, and what builders' rulers have beside them.
SCALES = (1, 2, 5, 10, 20, 25, 50, 75, 100, 125, 200, 250, 500, 1000, 2000, 5000)
FIT = "fit"  # in place of a size or a scale: one that fits
