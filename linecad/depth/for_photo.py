"""The depth map that a user gives with a photo: read as the options say, and laid onto the photo's pixels."""

from dataclasses import replace
from pathlib import Path

from linecad.camera.photo import Photo
from linecad.depth.depth_map import DepthMap, Reading
from linecad.depth.read import read_depth_map
from linecad.depth.to_photo import map_to_photo
from linecad.errors import OptionError
from linecad.options import Options


def check_depth_options(options: Options, is_given: bool) -> None:
    """Raise OptionError where a map is given to a program that looks at none, or options tell of one that is not."""
    if is_given and not options.uses_bodies:
        raise OptionError(
            "only formulation=bodies looks at a depth map; leave out the map, or --fast and the options that choose "
            "another formulation"
        )
    if not is_given and options.depth_keys:
        raise OptionError(
            f"option {options.depth_keys[0]} tells of a depth map, and none is given; name it with --depth, or those "
            "of many photos with --depth-maps"
        )


def open_depth_map(path: Path, photo: Photo, options: Options) -> DepthMap:
    """The map in a file, on the pixels of the photo. Raises DepthMapError.

    What the options say of its kind outweighs what the file tells.
    """
    found = read_depth_map(path, Reading(options.depth_array, options.depth_view, options.depth_factor))
    if options.depth_kind is not None:
        found = replace(found, kind=options.depth_kind)
    return map_to_photo(found, photo, options.depth_undistorted)
