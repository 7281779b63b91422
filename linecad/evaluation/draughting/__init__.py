"""A scene as a draughtsman would judge the drawing: what is missing, in pieces, jagged, double or left open."""
