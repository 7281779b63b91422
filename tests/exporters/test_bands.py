from dataclasses import replace

from exporters.bands import BANDS, GUESS, LIKELY, SURE, bands_of


def test_each_band_begins_with_its_smallest_probability(one_line):
    for probability, band in [(1, SURE), (0.9, SURE), (0.8999, LIKELY), (0.5, LIKELY), (0.4999, GUESS), (0, GUESS)]:
        assert bands_of(replace(one_line.lines, probability=[probability])).tolist() == [band]
    assert BANDS == ("sure", "likely", "guess")


def test_a_scene_that_does_not_tell_has_no_bands(scene):
    assert bands_of(scene.lines) is None
