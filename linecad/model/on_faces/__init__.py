"""Lines that faces place: their own edges, and edges in the photo that lie on them."""
