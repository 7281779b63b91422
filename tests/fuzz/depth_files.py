"""Small files of depth as networks and phones write them, made from arrays: for tests and as seeds of the fuzzer."""

import io
import struct
import tempfile
import zipfile
import zlib
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from PIL import Image

ZEROS = bytes(2**20)
Z_NEAR, Z_FAR = 0.5, 8.0  # m, of the phone's depth image


def npz_bytes(compressed=True, **arrays):
    stream = io.BytesIO()
    (np.savez_compressed if compressed else np.savez)(stream, **arrays)
    return stream.getvalue()


def npy_bytes(array, allow_pickle=False):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=allow_pickle)
    return stream.getvalue()


def npy_header(shape, descr="<f4", order=False):
    """The start of an .npy file that promises an array, without any of its numbers."""
    text = f"{{'descr': {descr!r}, 'fortran_order': {order}, 'shape': {shape!r}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text


def pfm_bytes(values, scale=-1.0):
    """Rows from the bottom up; a negative scale stands for little-endian numbers."""
    height, width = values.shape
    order = "<f4" if scale < 0 else ">f4"
    return f"Pf\n{width} {height}\n{scale}\n".encode() + values[::-1].astype(order).tobytes()


def picture_bytes(array, kind="PNG", **options):
    stream = io.BytesIO()
    Image.fromarray(array).save(stream, kind, **options)
    return stream.getvalue()


def exr_bytes(folder: Path, **channels):
    """Single-precision channels by name."""
    import OpenEXR

    path = folder / "made.exr"
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(
        header, {name: np.ascontiguousarray(each, np.float32) for name, each in channels.items()}
    ) as file:
        file.write(str(path))
    return path.read_bytes()


def points_of(depth, focal, center):
    """Points (H, W, 3) in the camera's frame that a pinhole sees at depths (H, W)."""
    y, x = np.mgrid[: depth.shape[0], : depth.shape[1]]
    return np.stack([(x - center[0]) / focal * depth, (y - center[1]) / focal * depth, depth], axis=-1)


def zip_bomb(megabytes):
    """An .npz that promises and holds far more zeros than it takes on the disk."""
    header = npy_header((megabytes, 2**18))
    # Zeros are compressed once and repeated: a full flush makes a block that is read without those before it.
    packer = zlib.compressobj(wbits=-zlib.MAX_WBITS)
    packed = packer.compress(header) + packer.flush(zlib.Z_FULL_FLUSH)
    packed += megabytes * (packer.compress(ZEROS) + packer.flush(zlib.Z_FULL_FLUSH)) + packer.flush()
    name, size = b"depth.npy", len(header) + megabytes * 2**20
    check = zlib.crc32(header)
    for _ in range(megabytes):
        check = zlib.crc32(ZEROS, check)
    sizes = struct.pack("<HHHHHIIIHH", 20, 0, zipfile.ZIP_DEFLATED, 0, 33, check, len(packed), size, len(name), 0)
    local = b"PK\3\4" + sizes + name
    central = b"PK\1\2" + struct.pack("<H", 20) + sizes + struct.pack("<HHHII", 0, 0, 0, 0, 0) + name
    end = b"PK\5\6" + struct.pack("<HHHHIIH", 0, 0, 1, 1, len(central), len(local) + len(packed), 0)
    return local + packed + central + end


# A HEIF file with a depth image: no library at hand writes one, so its boxes are put together here (ISO/IEC 23008-12)
# around two images that libheif coded.


def box(kind, *parts):
    body = b"".join(parts)
    return struct.pack(">I4s", 8 + len(body), kind) + body


def full_box(kind, *parts, version=0, flags=0):
    return box(kind, struct.pack(">I", version << 24 | flags), *parts)


def _coded(array):
    """The configuration box and the coded bytes of one image."""
    import pillow_heif

    stream = io.BytesIO()
    pillow_heif.from_pillow(Image.fromarray(array)).save(stream, quality=-1)
    data = stream.getvalue()
    at = data.index(b"hvcC") - 4
    configuration = data[at : at + struct.unpack(">I", data[at : at + 4])[0]]
    return configuration, data[data.index(b"mdat") + 4 :]


def _bits_of(value):
    """A positive number as the sign, exponent and mantissa of H.265's depth representation message, 1 + 7 + 5 + 16."""
    exponent = int(np.floor(np.log2(value)))
    mantissa = round((value / 2**exponent - 1) * 2**16)
    return f"0{exponent + 31:07b}{15:05b}{mantissa:016b}"


def _exp_golomb(number):
    text = f"{number + 1:b}"
    return "0" * (len(text) - 1) + text


def representation(kind, **limits):
    """H.265's message on what a depth image's numbers mean: kind 0 inverse z, 1 disparity, 2 z; limits by name."""
    names = ("z_near", "z_far", "d_min", "d_max")
    bits = "".join("1" if name in limits else "0" for name in names) + _exp_golomb(kind)
    if "d_min" in limits or "d_max" in limits:
        bits += _exp_golomb(0)
    bits += "".join(_bits_of(limits[name]) for name in names if name in limits) + "1"
    bits += "0" * (-len(bits) % 8)
    payload = int(bits, 2).to_bytes(len(bits) // 8, "big")
    return bytes([0x4E, 0x01, 177, len(payload)]) + payload + b"\x80"


def heic_bytes(photo, depth=None, message=b""):
    """A HEIC photo (H, W, 3), with a depth image (h, w) of 8 bits beside it."""
    images = [photo] if depth is None else [photo, depth]
    coded = [_coded(image) for image in images]
    sizes = [full_box(b"ispe", struct.pack(">II", image.shape[1], image.shape[0])) for image in images]
    properties = [each for size, (configuration, _) in zip(sizes, coded, strict=True) for each in (configuration, size)]
    links = [(1, (0x81, 2)), (2, (0x83, 4, 5))][: len(images)]
    if depth is not None:
        unit = struct.pack(">I", len(message)) + message
        subtype = struct.pack(">I", len(unit)) + unit if message else b""
        properties.append(full_box(b"auxC", b"urn:mpeg:hevc:2015:auxid:2\0", subtype))
    association = struct.pack(">I", len(links)) + b"".join(
        struct.pack(">HB", item, len(indices)) + bytes(indices) for item, indices in links
    )
    entries = [
        full_box(b"infe", struct.pack(">HH4s", item, 0, b"hvc1"), b"\0", version=2)
        for item in range(1, len(images) + 1)
    ]
    start = box(b"ftyp", b"heic", struct.pack(">I", 0), b"mif1heic")

    def meta(offset):
        locations = b""
        for item, (_, data) in enumerate(coded, 1):
            locations += struct.pack(">HHHII", item, 0, 1, offset, len(data))
            offset += len(data)
        return full_box(
            b"meta",
            full_box(b"hdlr", struct.pack(">I4s", 0, b"pict"), bytes(13)),
            full_box(b"pitm", struct.pack(">H", 1)),
            full_box(b"iloc", struct.pack(">BBH", 0x44, 0, len(coded)), locations),
            full_box(b"iinf", struct.pack(">H", len(entries)), *entries),
            *([] if depth is None else [full_box(b"iref", box(b"auxl", struct.pack(">HHH", 2, 1, 1)))]),
            box(b"iprp", box(b"ipco", *properties), full_box(b"ipma", association)),
        )

    offset = len(start) + len(meta(0)) + 8
    return start + meta(offset) + box(b"mdat", *(data for _, data in coded))


def depth_seeds():
    """One small map of each kind that is read by the libraries that are installed."""
    y, x = np.mgrid[:16, :24]
    depth = (3 + x * 0.1 + y * 0.01).astype(np.float32)
    points = points_of(depth, 20.0, (11.5, 7.5)).astype(np.float32)
    matrix = np.array([[20.0, 0, 11.5], [0, 20, 7.5], [0, 0, 1]])
    normal = np.tile(np.float32([0, 0, -1]), (16, 24, 1))
    yield npz_bytes(depth=depth)
    yield npz_bytes(False, depth=depth, points=points, normal=normal, mask=depth > 0, intrinsics=matrix)
    yield npz_bytes(False, depth=depth[None], conf=depth[None], intrinsics=matrix[None])
    yield npz_bytes(False, points=points)
    yield npz_bytes(False, predicted_depth=depth.astype(np.float16), focallength_px=np.array(20.0))
    yield npy_bytes(depth)
    yield npy_bytes(points)
    yield npy_bytes(np.asfortranarray(depth.astype(">f8")))
    yield pfm_bytes(depth)
    yield pfm_bytes(depth, 1.0)
    yield picture_bytes((depth * 256).astype(np.uint16))
    yield picture_bytes((depth * 30).astype(np.uint8))
    yield picture_bytes(normal.astype(np.uint8))
    yield picture_bytes(depth, "TIFF")
    yield picture_bytes((depth * 256).astype(np.uint16), "TIFF", compression="tiff_lzw")
    if find_spec("OpenEXR"):
        with tempfile.TemporaryDirectory() as name:
            yield exr_bytes(Path(name), Y=depth)
            yield exr_bytes(Path(name), R=points[..., 0], G=points[..., 1], B=points[..., 2])
    if find_spec("pillow_heif"):
        photo, steps = np.full((64, 64, 3), 90, np.uint8), np.tile(np.arange(64, dtype=np.uint8), (64, 1))
        yield heic_bytes(photo, steps, representation(0, z_near=Z_NEAR, z_far=Z_FAR))
        yield heic_bytes(photo)
