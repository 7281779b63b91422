"""What a user may choose about a drawing."""

from dataclasses import dataclass

from exporters.drawings.sizes import FIT


@dataclass(frozen=True)
class Choice:
    """The options of a drawing, as exporters.formats has them."""

    facade: int = 0  # 0 is the largest
    drawing_scale: str = FIT  # 1:N, or FIT
    paper: str = FIT  # one of exporters.drawings.sizes.SIZES, or FIT
    dpi: int = 200  # of the photo, on the paper
    underlay: bool = True  # whether the photo lies beneath the lines
