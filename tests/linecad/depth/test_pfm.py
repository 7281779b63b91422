"""Portable float maps, from the bottom up."""

import numpy as np
import pytest
from depth_files import pfm_bytes
from hypothesis import given
from hypothesis import strategies as st

from linecad.depth.depth_map import Reading
from linecad.depth.pfm import read_pfm
from linecad.errors import DepthMapError


@pytest.mark.parametrize("scale", [-1.0, 1.0, "-1", "1.0e0"])
def test_both_orders_of_bytes(depth, read, scale):
    data = pfm_bytes(depth, float(scale)).replace(str(float(scale)).encode(), str(scale).encode(), 1)
    found = read(data)
    np.testing.assert_array_equal(found.values, depth)
    assert found.kind is None


def test_colours_and_cut_off_files_are_refused(depth, refuse):
    data = pfm_bytes(depth)
    assert "coloured picture" in refuse(data.replace(b"Pf", b"PF", 1))
    assert "cut off" in refuse(data[:-1])
    assert "header" in refuse(b"Pf\n60 forty\n-1\n")
    assert "header" in refuse(b"Pf")


def test_a_header_that_asks_for_100_gigabytes(refuse):
    assert "more than linecad takes" in refuse(b"Pf\n200000 125000\n-1.0\n" + bytes(100))


@given(st.binary(max_size=100))
def test_any_header_is_refused_in_one_line(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "any.pfm"
    path.write_bytes(b"Pf" + data)
    with pytest.raises(DepthMapError) as caught:
        read_pfm(path, Reading())
    assert "\n" not in str(caught.value)
