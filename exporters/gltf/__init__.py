"""GLB: the document, its materials, and lines as tubes."""
