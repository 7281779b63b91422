"""The frame of our HTML pages."""

import html.parser

from linecad.io.html import page


class Reader(html.parser.HTMLParser):
    """The tags of a page in their order, and its words outside of the style."""

    def __init__(self):
        super().__init__()
        self.tags, self.words = [], []

    def handle_starttag(self, tag, _attributes):
        self.tags.append(tag)

    def handle_data(self, data):
        if self.tags[-1:] != ["style"]:
            self.words += data.split()


def test_a_page_has_its_frame_and_its_body():
    reader = Reader()
    text = page("results", "p { color: red; }\n", ["<p>one</p>", "<p>two</p>"])
    reader.feed(text)
    assert text.startswith("<!DOCTYPE html>\n")
    assert reader.tags == ["html", "head", "meta", "meta", "title", "style", "body", "p", "p"]
    assert reader.words == ["results", "one", "two"]
    assert text.index("font:") < text.index("p { color: red; }") < text.index("</style>")


def test_a_title_is_only_text():
    assert "<title>&lt;script&gt; &amp; co</title>" in page("<script> & co", "", [])


def test_a_page_can_load_and_run_nothing():
    text = page("a", "", [])
    assert "default-src 'none'; img-src data:; style-src 'unsafe-inline'" in text
    assert "script-src" not in text
