"""3DM: the objects on their layers, planar breps with holes, and the bytes that do not change from day to day."""
