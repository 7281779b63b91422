"""Files: whole or not at all, locked where several write, JSON read strictly, the scene file."""
