"""Drawings at scale: the elevation of a facade and the plan, as SVG, PDF, DXF and TIFF."""
