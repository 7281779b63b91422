"""Maps found by their names, and told from photos."""

import pytest

from linecad.dataset.store import DEPTH_MAP, PHOTO
from linecad.depth.beside import NAMES, find_map, find_maps, photos_alone
from linecad.errors import DepthMapError


@pytest.fixture
def place(tmp_path):
    """A function that makes files, and gives the path of the first."""

    def make(*names):
        for name in names:
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_bytes(b"1")
        return tmp_path / names[0]

    return make


@pytest.mark.parametrize(
    "name",
    [
        "house.depth.npz", "house.depth.npy", "house.depth.exr", "house.depth.pfm", "house.depth.png",
        "house.depth.tif", "house.depth.tiff", "house_depth.npy", "house_depth.png",
        "house_raw_depth_meter.npy", "house/depth.exr", "house.npz",
    ],
)  # fmt: skip
def test_every_name_is_found(place, tmp_path, name):
    photo = place("house.jpg", name)
    assert find_map(photo) == tmp_path / name


@pytest.mark.parametrize("name", ["depth.npz", "house.jpg.npz", "houses.depth.npz", "house.npy", "house/mask.png"])
def test_other_names_are_none(place, name):
    assert find_map(place("house.jpg", name)) is None


def test_the_first_name_wins_until_it_is_gone(place, tmp_path):
    photo = place("house.jpg", *(name.format(stem="house") for name in NAMES))
    for name in NAMES:
        assert find_map(photo) == tmp_path / name.format(stem="house")
        find_map(photo).unlink()
    assert find_map(photo) is None


def test_made_scenes_have_their_map_under_such_a_name(place):
    photo = place(PHOTO, DEPTH_MAP, "truth.npz")
    assert find_map(photo) == photo.with_name(DEPTH_MAP)


def test_a_folder_of_such_a_name_is_no_map(tmp_path, place):
    photo = place("house.jpg")
    (tmp_path / "house.depth.npz").mkdir()
    assert find_map(photo) is None


def test_braces_in_the_name_of_a_photo_are_nothing_special(place, tmp_path):
    photo = place("{stem}{0}.jpg", "{stem}{0}.depth.npz")
    assert find_map(photo) == tmp_path / "{stem}{0}.depth.npz"


def test_maps_of_others_are_no_photos(place, tmp_path):
    photos = ["a.jpg", "a.depth.png", "a_depth.tif", "b.depth.png", "deep/c.jpg", "deep/c/normal.png", "deep/d/e.png"]
    place(*photos, "deep/c/depth.exr")
    found = photos_alone(tmp_path / name for name in photos)
    # That which is the map of no photo here may be a photo.
    assert [str(path.relative_to(tmp_path)) for path in found] == ["a.jpg", "b.depth.png", "deep/c.jpg", "deep/d/e.png"]


def test_photos_without_any_map_are_told_how_to_name_one(place):
    first = place("a.jpg", "b.jpg", "b.depth.npz")
    second = first.with_name("b.jpg")
    assert find_maps([first, second]) == {second: first.with_name("b.depth.npz")}
    with pytest.raises(DepthMapError, match=r"name them like .*a\.depth\.npz"):
        find_maps([first])
