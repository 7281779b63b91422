"""Arrays are read back as they were written; pickles, bombs and lies in headers are not."""

import io
import pickle
import time
import tracemalloc
import zipfile

import numpy as np
import pytest
from depth_files import npy_bytes, npy_header, npz_bytes, zip_bomb
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from linecad.depth.arrays_in_files import MOST_ARRAYS, _read_array
from linecad.errors import DepthMapError

LITTLE_MEMORY = 2**24  # bytes; a file's own and Python's


class Boom:
    """Says so when it is unpickled."""

    loaded = False

    def __reduce__(self):
        return (setattr, (Boom, "loaded", True))


@given(
    arrays.arrays(
        st.sampled_from(["<f4", ">f8", "<f2", "|u1", "<u2", "|b1", "<i8"]), arrays.array_shapes(min_dims=0, min_side=0)
    ),
    st.booleans(),
)
def test_arrays_of_numbers_are_read_as_numpy_reads_them(array, by_columns):
    data = npy_bytes(np.asfortranarray(array) if by_columns else array)
    found = _read_array(io.BytesIO(data), len(data), "here")
    assert found.dtype == array.dtype
    np.testing.assert_array_equal(found, np.load(io.BytesIO(data)))


@given(st.binary(max_size=300))
def test_no_bytes_after_the_magic_are_an_array_by_chance(data):
    data = b"\x93NUMPY" + data
    with pytest.raises(DepthMapError, match="here is damaged"):
        _read_array(io.BytesIO(data), len(data), "here")


@pytest.mark.parametrize("where", ["npy", "npz", "npz beside"])
def test_pickles_are_never_loaded(refuse, read, depth, where):
    array = np.array([Boom()], dtype=object)
    if where == "npz beside":
        np.testing.assert_array_equal(read(npz_bytes(depth=depth, extra=array)).values, depth)
    else:
        message = refuse(npy_bytes(array, allow_pickle=True) if where == "npy" else npz_bytes(depth=array))
        assert "never loads" in message or "nothing that is made of numbers" in message
    assert not Boom.loaded
    assert "not a depth map" in refuse(pickle.dumps(np.ones((40, 60))))
    np.load(io.BytesIO(npy_bytes(array, allow_pickle=True)), allow_pickle=True)
    assert Boom.loaded  # it would have been seen
    Boom.loaded = False


@pytest.mark.parametrize("shape", [(200_000, 125_000), (40, 60, 10**10), (2**40, 2**40), (10**30, 2)])
@pytest.mark.parametrize("suffix", ["npy", "npz"])
def test_a_header_that_asks_for_100_gigabytes_takes_no_memory(refuse, shape, suffix):
    data = npy_header(shape) + bytes(1000)
    if suffix == "npz":
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("depth.npy", data)
        data = stream.getvalue()
    tracemalloc.start()
    try:
        assert "too much for depth" in refuse(data)
        assert tracemalloc.get_traced_memory()[1] < LITTLE_MEMORY
    finally:
        tracemalloc.stop()


def test_a_header_that_asks_for_more_than_is_there_takes_no_memory(refuse):
    tracemalloc.start()
    try:
        assert "cut off" in refuse(npy_header((10_000, 20_000)) + bytes(1000))
        assert tracemalloc.get_traced_memory()[1] < LITTLE_MEMORY
    finally:
        tracemalloc.stop()


def test_a_zip_bomb_is_refused_at_once(refuse):
    data = zip_bomb(1100)
    assert len(data) < 2_000_000
    began = time.process_time()
    assert "too much for depth" in refuse(data)
    assert time.process_time() - began < 1


def test_a_member_that_inflates_to_less_than_it_says(refuse):
    stream = io.BytesIO()
    content = npy_header((1000, 1000)) + bytes(12_345)
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("depth.npy", content)
    data = bytearray(stream.getvalue())
    at = data.rindex(len(content).to_bytes(4, "little"))  # in the directory at the end
    assert "cut off" in refuse(bytes(data))
    data[at : at + 4] = (2**24).to_bytes(4, "little")
    assert "cut off" in refuse(bytes(data)) or "damaged" in refuse(bytes(data))


@pytest.mark.parametrize(
    "header",
    [
        b"",
        b"{",
        b"{}",
        b"{'descr': '<f4', 'fortran_order': False, 'shape': (-1, 60)}",
        b"{'descr': '<f4', 'fortran_order': False, 'shape': (True, 60)}",
        b"{'descr': '<f4', 'fortran_order': 0, 'shape': (40, 60)}",
        b"{'descr': '<f4', 'fortran_order': False, 'shape': 40}",
        b"[" * 5000,
        b"__import__('os').system('true')",
        b"{'descr': '<f4', 'fortran_order': False, 'shape': (1" + b"0" * 5000 + b",)}",
    ],
)
def test_headers_that_are_not_numpys(refuse, header):
    data = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header
    assert "its header is not NumPy's" in refuse(data)


def test_a_header_of_version_2_and_one_that_is_too_long(read, refuse, depth):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, depth, version=(2, 0))
    np.testing.assert_array_equal(read(stream.getvalue()).values, depth)
    assert "header" in refuse(b"\x93NUMPY\x02\x00" + (2**31).to_bytes(4, "little") + bytes(100))


def test_too_many_arrays(refuse, depth):
    data = npz_bytes(depth=depth, **{f"a{number}": np.ones(1) for number in range(MOST_ARRAYS)})
    assert f"holds {MOST_ARRAYS + 1} arrays" in refuse(data)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99])
@pytest.mark.parametrize("suffix", ["npy", "npz"])
def test_files_that_are_cut_off(refuse, depth, share, suffix):
    data = npy_bytes(depth) if suffix == "npy" else npz_bytes(depth=depth)
    assert refuse(data[: int(share * len(data))])


def test_a_flipped_byte_is_noticed_or_harmless(read, depth):
    """A checksum guards every member."""
    data = npz_bytes(depth=depth)
    for at in range(60, len(data) - 200, 97):
        changed = bytearray(data)
        changed[at] ^= 0x55
        try:
            found = read(bytes(changed))
        except DepthMapError:
            continue
        np.testing.assert_array_equal(found.values, depth)
