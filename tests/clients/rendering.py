"""Render the faces through the scene's camera in Blender and compare the picture with the photo."""

import bpy
import numpy as np

SAMPLES = 16  # a pixel
EDGE = 2  # px at the border of the photo that are left out
LEAST_COVERED = 0.05  # share of the picture
LARGEST_MEDIAN, LARGEST_95TH = 4.0, 25.0  # of 255; JPEG and resampling leave about 1 and 9


def check_render(findings, faces, target, photo, scale):
    """Render `faces` to `target`, `scale` times as large as the photo, and need it to look like the photo."""
    rendered = render(faces, target, scale)
    taken = read(photo)
    covered = rendered[..., 3] > 0.999
    wanted = shrunk(taken[..., :3], rendered.shape[:2])
    for axis in range(2):
        count = rendered.shape[axis]
        at = np.arange(count) + 0.5
        within = (at > EDGE * scale) & (at < count - EDGE * scale)
        covered &= within[:, None] if axis == 0 else within[None, :]
    share = float(covered.mean())
    if not findings.need(share > LEAST_COVERED, f"the faces cover {share:.1%} of the picture"):
        return
    difference = 255 * np.abs(rendered[covered][:, :3] - wanted[covered]).max(axis=1)
    median, high = float(np.median(difference)), float(np.percentile(difference, 95))
    told = f"the faces differ from the photo by {median:.1f} (median) and {high:.1f} (95 %) of 255"
    print(f"{told}, over {share:.0%} of the picture")
    findings.need(median <= LARGEST_MEDIAN and high <= LARGEST_95TH, told)


def render(faces, target, scale):
    """RGBA, (H, W, 4), 0 to 1, of the faces alone, with the materials that they came with."""
    scene = bpy.context.scene
    for item in bpy.data.objects:
        item.hide_render = item not in faces and item.type not in ("CAMERA", "EMPTY")
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    scene.cycles.max_bounces = 0  # the photo on the faces shines; what it would light is not wanted
    for material in bpy.data.materials:
        if hasattr(material.cycles, "emission_sampling"):  # from Blender 3.5; it takes most of the time
            material.cycles.emission_sampling = "NONE"
    scene.cycles.use_denoising = False
    scene.cycles.filter_width = 1.0
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"  # not one that changes the colours for beauty
    scene.render.resolution_percentage = round(100 * scale)
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.filepath = str(target.resolve())
    bpy.ops.render.render(write_still=True)
    return read(target)


def read(path):
    """(H, W, 4), 0 to 1, the first row at the top."""
    image = bpy.data.images.load(str(path.resolve()))
    width, height = image.size
    values = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, 4)[::-1]


def shrunk(picture, shape):
    """A picture of `shape` (rows, columns), each pixel the mean of those of `picture` that it lies over."""
    for axis, count in enumerate(shape):
        total = np.cumsum(picture, axis=axis, dtype=np.float64)
        total = np.concatenate([np.zeros_like(total.take([0], axis=axis)), total], axis=axis)
        borders = np.arange(count + 1) * (picture.shape[axis] / count)
        below = np.minimum(borders.astype(int), picture.shape[axis] - 1)
        part = (borders - below).reshape([-1 if each == axis else 1 for each in range(picture.ndim)])
        at = total.take(below, axis=axis) * (1 - part) + total.take(below + 1, axis=axis) * part
        picture = np.diff(at, axis=axis) * (count / picture.shape[axis])
    return picture
