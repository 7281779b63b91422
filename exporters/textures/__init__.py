"""The photo on the faces: rectified patches, packed into pages, written beside a file or into it."""
