"""Windows and doors: rectangles of lines in vertical planes, in rows and columns, checked in the photo."""
