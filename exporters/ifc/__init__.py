"""IFC: the document, walls with their openings, and everything else of a building."""
