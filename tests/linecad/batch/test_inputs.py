"""What the command names becomes photos, each once, and each gets a name of its own in the folder."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from linecad.batch.inputs import LONGEST_NAME, find_photos, output_names
from linecad.errors import PhotoError


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a.jpg", "b.PNG", "notes.txt", ".hidden.jpg", "deep/c.tif", ".git/d.jpg", "out/e.png", "[x].jpg"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"photo")
    return tmp_path


def names(photos):
    return [photo.name for photo in photos]


def test_folder_gives_its_photos_and_those_below_but_not_what_the_batch_made(folder):
    assert names(find_photos(["."], folder / "out")) == ["[x].jpg", "a.jpg", "b.PNG", "c.tif"]


def test_pattern_gives_what_it_matches(folder):
    assert names(find_photos(["*.jpg"], folder / "out")) == ["[x].jpg", "a.jpg"]
    assert names(find_photos([f"{folder}/**/*.tif"], folder / "out")) == ["c.tif"]


def test_a_file_may_be_called_like_a_pattern(folder):
    assert names(find_photos(["[x].jpg"], folder / "out")) == ["[x].jpg"]


def test_a_file_named_is_taken_whatever_its_suffix(folder):
    assert names(find_photos(["notes.txt"], folder / "out")) == ["notes.txt"]


def test_each_photo_comes_once_however_often_it_is_named(folder):
    (folder / "link.jpg").symlink_to(folder / "a.jpg")
    found = find_photos(["a.jpg", "./a.jpg", str(folder / "a.jpg"), "deep/../a.jpg", "link.jpg"], folder / "out")
    assert found == [folder.resolve() / "a.jpg"]


@pytest.mark.parametrize("name", ["missing.jpg", "*.bmp", "out/../nothing", "**x", "\0"])
def test_a_name_that_finds_nothing_is_an_error(folder, name):
    with pytest.raises(PhotoError, match="check the name"):
        find_photos(["a.jpg", name], folder / "out")


def test_a_folder_without_photos_is_an_error(folder):
    (folder / "empty").mkdir()
    with pytest.raises(PhotoError, match="holds no photos"):
        find_photos(["empty"], folder / "out")


def test_photos_of_one_name_get_different_ones_whatever_their_order():
    photos = [Path("/p/a/front.jpg"), Path("/p/b/Front.jpg"), Path("/p/c/back.jpg")]
    forward, backward = output_names(photos, {}), output_names(photos[::-1], {})
    assert forward == backward
    assert forward[photos[2]] == "back"
    assert len({name.casefold() for name in forward.values()}) == 3


def test_names_in_the_record_stay():
    old, new = Path("/p/a/front.jpg"), Path("/p/b/front.jpg")
    found = output_names([new, old], {str(old): "front"})
    assert found[old] == "front"
    assert found[new] != "front"


@given(st.lists(st.text(min_size=1, max_size=200), min_size=1, max_size=8, unique=True))
def test_any_file_name_gives_a_plain_name_in_the_folder(stems):
    photos = [Path("/p") / str(number) / f"{stem}.jpg".replace("/", "_") for number, stem in enumerate(stems)]
    found = output_names(photos, {})
    assert len({name.casefold() for name in found.values()}) == len(photos)
    for name in found.values():
        assert Path(name).name == name
        assert not name.startswith(".")
        assert not set(name) & set('\0\n\r\\:*?"<>|')
        assert len(name.encode()) <= LONGEST_NAME + 9
        assert os.fsencode(name)
