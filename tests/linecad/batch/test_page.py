"""The page needs nothing but itself, and no name in it can do anything."""

import html.parser
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.batch.job import Figures, Outcome
from linecad.batch.page import NAME, write_page
from linecad.batch.record import Row

PICTURE = b"\xff\xd8 a picture"
HOSTILE = '<img src=x onerror="alert(1)">&quot;\'<script>alert(2)<!--.jpg'


class Reader(html.parser.HTMLParser):
    """What a browser would make of the page."""

    def __init__(self):
        super().__init__()
        self.tags, self.addresses, self.attributes, self.words = [], [], set(), ""

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes |= {name for name, _ in attributes}
        self.addresses += [value for name, value in attributes if name in ("src", "href")]

    def handle_data(self, data):
        self.words += data


def page_of(folder, *rows):
    write_page(folder, rows)
    reader = Reader()
    reader.feed((folder / NAME).read_text(encoding="utf-8"))
    return reader


def row(photo, name="facade", **changes):
    figures = Figures(20, 30, 25, 4, 5, 0.015, "time limit", (), "poor")
    files = {f"{name}.step": 10, f"thumbnails/{name}.jpg": len(PICTURE)}
    return Row(photo, "0" * 64, "f" * 64, name, Outcome("done", "", 2.0, 1.0, 200.0, figures, files), **changes)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "thumbnails").mkdir()
    (tmp_path / "thumbnails" / "facade.jpg").write_bytes(PICTURE)
    return tmp_path


def test_a_photo_has_its_picture_figures_and_files(folder):
    page = page_of(folder, row("/p/facade.jpg"))
    assert "facade.jpg" in page.words
    assert "20 lines, 25 of 30 crossings real" in page.words
    assert "gap 1.50%, camera poor" in page.words
    assert page.addresses == ["data:image/jpeg;base64,/9ggYSBwaWN0dXJl", "./facade.step"]


def test_a_photo_says_which_map_it_had(folder):
    page = page_of(folder, row("/p/facade.jpg", depth="/p/facade/depth.exr"), row("/p/a.jpg", depth=f"/q/{HOSTILE}"))
    assert "depth map: facade/depth.exr" in page.words
    assert f"depth map: /q/{HOSTILE}" in page.words
    assert "depth map" not in page_of(folder, row("/p/facade.jpg")).words


def test_a_photo_that_failed_says_why(folder):
    page = page_of(folder, Row("/p/a.jpg", "", "", "a", Outcome("failed", "no group of lines was found")))
    assert "no group of lines was found" in page.words
    assert "1 photos, 0 done, 1 failed" in page.words


def test_nothing_is_fetched_from_anywhere(folder):
    text_of = page_of(folder, row("/p/facade.jpg")).addresses
    assert all(address.startswith(("data:image/jpeg;base64,", "./")) for address in text_of)
    assert "default-src 'none'" in (folder / NAME).read_text()


def test_a_hostile_name_is_only_text(folder):
    page = page_of(folder, row(f"/p/{HOSTILE}"), Row("/p/x.jpg", "", "", "x", Outcome("failed", HOSTILE)))
    assert page.tags.count("script") == 0
    assert page.tags.count("img") == 1
    assert not any(name.startswith("on") for name in page.attributes)
    assert page.words.count("<script>alert(2)<!--") == 2


@given(st.text(min_size=1, max_size=60), st.text(max_size=60))
def test_any_name_and_any_error_are_only_text(tmp_path_factory, name, error):
    folder = tmp_path_factory.mktemp("page")
    files = {f"{name}.step": 1}
    bad = Row(f"/p/{name}", "", "", name, Outcome("failed", error, files=files))
    page = page_of(folder, bad)
    known = {"html", "head", "body", "meta", "title", "style", "h1", "p", "main", "article", "h2", "a"}
    assert set(page.tags) <= known
    assert page.attributes <= {"lang", "charset", "http-equiv", "content", "class", "href"}
    assert all(address.startswith("./") for address in page.addresses)


def test_a_name_that_is_not_utf_8(folder):
    assert "photo" in page_of(folder, row("/p/photo\udcff.jpg")).words


def test_a_picture_too_large_to_be_ours_is_left_out(folder):
    (folder / "thumbnails" / "facade.jpg").write_bytes(bytes(2_000_000))
    assert "img" not in page_of(folder, row("/p/facade.jpg")).tags


def test_links_lead_to_files_beside_the_page(folder):
    page = page_of(folder, row("/p/facade.jpg", name="a b#c?d"))
    assert page.addresses == ["./a%20b%23c%3Fd.step"]
    assert Path(NAME).suffix == ".html"
