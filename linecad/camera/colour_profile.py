"""Photos in the colours of sRGB, which every format and viewer takes textures for.

Telephones write Display P3 and cameras Adobe RGB, in which the same numbers are more vivid colours.
"""

import io

from PIL import Image, ImageCms

IDENTICAL = "sRGB"  # begins the descriptions of profiles that say what is assumed without one
CONVERTED = ("RGB", "RGBA", "P", "CMYK")  # modes of pixels that a profile is for; P by the colours of its palette


def in_srgb(image: Image.Image) -> tuple[Image.Image, list[str]]:
    """A loaded image with its pixels in sRGB, by the ICC profile that it holds, and notes; the same without one."""
    data = image.info.get("icc_profile")
    if not data or image.mode not in CONVERTED:
        return image, []
    if image.mode == "P":
        image = image.convert("RGBA" if image.has_transparency_data else "RGB")
    mode = "RGBA" if image.mode == "RGBA" else "RGB"
    try:
        profile = ImageCms.ImageCmsProfile(io.BytesIO(data))
        if ImageCms.getProfileDescription(profile).strip().startswith(IDENTICAL):
            return image, []
        converted = ImageCms.profileToProfile(image, profile, ImageCms.createProfile("sRGB"), outputMode=mode)
    except (ImageCms.PyCMSError, OSError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        return image, [f"the photo's colour profile cannot be used ({reason}); its colours are taken for sRGB"]
    assert converted is not None  # None only where the pixels are changed in place
    return converted, []
