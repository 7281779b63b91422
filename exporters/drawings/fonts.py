"""The font of drawings: the one that comes with Pillow, free of rights, the same on every machine.

It has the letters of ASCII and few others; what it lacks is written as a question mark.
"""

from functools import cache

from exporters.picture.canvas import default_font, drawable, text_width

__all__ = ["FAMILY", "drawable", "font_file", "shortened", "width_of", "wrapped"]

FAMILY = "Aileron, Helvetica, Arial, sans-serif"  # where a reader chooses the font, in this order
_MEASURED = 100  # px, the size at which widths are measured


def font_file() -> bytes:
    """The TrueType file of the font."""
    data = default_font(_MEASURED).font_bytes
    assert isinstance(data, bytes)  # Pillow has it in memory
    return data


@cache
def width_of(text: str, size: float) -> float:
    """Mm that a text is wide in a font of `size` mm."""
    return text_width(text, _MEASURED) / _MEASURED * size


def wrapped(text: str, size: float, width: float) -> list[str]:
    """A text in lines of at most `width` mm, broken between words; a longer word has a line of its own."""
    lines: list[str] = []
    for word in text.split():
        if lines and width_of(f"{lines[-1]} {word}", size) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


def shortened(text: str, size: float, width: float) -> str:
    """A text, cut off with dots where it is wider than `width` mm."""
    if width_of(text, size) <= width:
        return text
    while text and width_of(f"{text}...", size) > width:
        text = text[:-1]
    return f"{text}..."
