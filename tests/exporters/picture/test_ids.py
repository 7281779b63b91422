"""The ids on the picture: each at its line, none over another, the longest lines first."""

import numpy as np
import pytest

from exporters.formats import export
from exporters.picture.canvas import Canvas, text_width
from exporters.picture.ids import draw_ids


def drawn(scene, width=1400):
    """The texts on a panel of the photo's form, and how many they are said to be."""
    camera = scene.camera
    scale = width / camera.width
    panel = Canvas(width, round(camera.height * scale), (1, 1, 1))
    return panel.texts, draw_ids(panel, scene, scene.lines.segment * scale), scene.lines.segment * scale


def test_ids_stand_on_their_lines(scene):
    texts, count, ends = drawn(scene)
    assert len(texts) == count > 0
    row = {str(number): at for at, number in enumerate(scene.lines.id.tolist())}
    assert len({text.text for text in texts}) == count
    for text in texts:
        start, end = ends[row[text.text]]
        along = (end - start) / np.linalg.norm(end - start)
        off = np.array([text.x, text.y]) - start
        assert abs(along[0] * off[1] - along[1] * off[0]) < 1
        assert 0 < along @ off < np.linalg.norm(end - start)


@pytest.mark.parametrize("width", [1400, 300])
def test_no_id_covers_another(scene, width):
    texts, _, _ = drawn(scene, width)
    for number, one in enumerate(texts):
        for other in texts[:number]:
            apart = (text_width(one.text, one.size) + text_width(other.text, other.size)) / 2
            assert abs(one.x - other.x) >= apart or abs(one.y - other.y) >= one.size


def test_where_there_is_room_for_one_it_is_the_longest_of_component_0(scene):
    texts, count, ends = drawn(scene, 60)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) * (scene.lines.component == 0)
    assert count < len(scene.lines)
    assert texts[0].text == str(scene.lines.id[length.argmax()])


def test_the_option_changes_the_picture_alone_where_it_is_on(scene, tmp_path):
    for name, ids in (("a", False), ("b", True), ("c", None)):
        export(scene, tmp_path / f"{name}.png", options={} if ids is None else {"ids": ids})
    a, b, c = (tmp_path.joinpath(f"{name}.png").read_bytes() for name in "abc")
    assert a == c != b
