"""Options of the formats: what is read, what is refused in one line, and that the writers take what the table says."""

import importlib
import inspect
from pathlib import Path

import pytest

from exporters.drawings.choice import Choice
from exporters.format_options import MODEL_OPTIONS, TEXTURES
from exporters.formats import FORMATS, export, options_for
from exporters.options import Option, read_options
from linecad.errors import OutputError

SWITCH = Option("thick", False, "x")
WORD = Option("release", "R1", "x", words=("R1", "r2"))
NUMBER = Option("some-size", 512, "x", least=16, most=4096)
LENGTH = Option("some-length", 0.3, "x", least=0.01, most=5)
OPTIONS = {".a": (SWITCH, WORD), ".b": (NUMBER, WORD)}

every_option = pytest.mark.parametrize(
    ("suffix", "option"),
    [(suffix, option) for suffix, row in FORMATS.items() for option in row.options],
    ids=lambda value: value.key if isinstance(value, Option) else value,
)


@pytest.mark.parametrize(
    ("option", "text", "value"),
    [
        (SWITCH, "on", True),
        (SWITCH, "OFF", False),
        (WORD, "r1", "R1"),
        (WORD, "R2", "r2"),
        (NUMBER, "16", 16),
        (NUMBER, "4096", 4096),
        (LENGTH, "0.01", 0.01),
        (LENGTH, "5", 5.0),
        (LENGTH, "0.125", 0.125),
    ],
)
def test_a_value_is_read(option, text, value):
    assert option.read(text) == value


@pytest.mark.parametrize(
    ("option", "text"),
    [
        *[(SWITCH, text) for text in ("", "yes", "1", " on")],
        *[(WORD, text) for text in ("", "R3", "R1 ")],
        *[(NUMBER, text) for text in ("", "15", "4097", "16.0", "-16", "1e2", "٣٢", "9" * 5000, "+32")],
        *[
            (LENGTH, text)
            for text in ("", "0.009", "5.1", "0,3", ".3", "3.", "1e-1", "nan", "inf", "-1", "٣", "9" * 5000)
        ],
    ],
)
def test_a_value_that_is_none_is_refused_with_what_is_accepted(option, text):
    with pytest.raises(OutputError) as caught:
        option.read(text)
    assert f"option {option.key} is " in str(caught.value)
    assert option.accepted in str(caught.value)
    assert len(str(caught.value)) < 200


def test_keys_of_all_formats_may_be_given_and_the_last_one_counts():
    assert read_options(["thick=on", "some-size=99", "thick=off"], OPTIONS) == {"thick": False, "some-size": 99}
    assert read_options([], OPTIONS) == {}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("thick", "no value; write it like KEY=VALUE"),
        ("=on", "no option '' for .a, .b, which has thick, release, some-size"),
        ("thin=on", "no option 'thin' for .a, .b"),
        ("line\nbreak=on", r"no option 'line\nbreak'"),
        ("thick=on=off", "option thick is 'on=off', expected on or off"),
    ],
)
def test_what_is_no_option_is_told_in_one_line(text, told):
    with pytest.raises(OutputError) as caught:
        read_options([text], OPTIONS)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_option_of_a_format_that_is_not_written_is_refused():
    assert options_for([Path("a.glb"), Path("b.DXF")], ["tubes=on"]) == {"tubes": True}
    with pytest.raises(OutputError, match=r"no option 'tubes' for \.dxf, which has version"):
        options_for([Path("b.dxf")], ["tubes=on"])
    with pytest.raises(OutputError, match=r"for \.png, which has ids"):
        options_for([Path("b.png")], ["tubes=on"])


def test_an_option_is_passed_only_to_the_format_that_has_it(scene, tmp_path):
    values = options_for([Path("a.glb"), Path("a.dxf")], ["tubes=on"])
    export(scene, tmp_path / "a.dxf", options=values)
    export(scene, tmp_path / "plain.dxf")
    assert (tmp_path / "a.dxf").read_bytes() == (tmp_path / "plain.dxf").read_bytes()


@every_option
def test_the_writer_takes_it_with_the_default_of_the_table(suffix, option):
    parameters = inspect.signature(importlib.import_module(FORMATS[suffix].module).write).parameters
    if option in MODEL_OPTIONS:  # the model is made by these
        assert option.name not in parameters
    elif option in TEXTURES:  # what is made of these goes to the writer
        assert parameters["textures"].default is None
    elif "chosen" in parameters:  # a drawing takes them as one record
        assert getattr(Choice(), option.name) == option.default
    else:
        assert parameters[option.name].default == option.default


@every_option
def test_the_default_can_be_written_as_the_list_shows_it(suffix, option):
    assert option in FORMATS[suffix].options
    assert option.read(option.usual) == option.default
    assert option.phrase
    assert "\n" not in option.phrase + option.accepted


def test_a_key_means_one_thing():
    meanings = {}
    for row in FORMATS.values():
        for option in row.options:
            assert meanings.setdefault(option.key, option) == option
