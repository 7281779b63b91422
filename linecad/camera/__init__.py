"""The photo and its camera: decoding, EXIF, intrinsics, vanishing points, distortion, and how sure all that is."""
