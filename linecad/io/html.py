"""The frame and the style that all our HTML pages share: each is one file that loads nothing and runs nothing."""

from collections.abc import Iterable
from html import escape

# Nothing in a page can load or run anything, whatever the name of a file in it says.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
STYLE = """\
body { font: 15px/1.45 system-ui, sans-serif; color: #222; }
.quiet { color: #666; } .error { color: #a11; }
"""


def page(title: str, style: str, body: Iterable[str]) -> str:
    """A whole page from its title as plain text, the style of its own and the lines of its body, which are HTML."""
    head = [
        "<!DOCTYPE html>",
        '<html lang="en">',
        '<head><meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        f"<title>{escape(title)}</title>",
        f"<style>\n{STYLE}{style}</style>",
        "</head>",
        "<body>",
    ]
    return "\n".join([*head, *body, "</body>", "</html>\n"])
