"""Formulation "gain": one potential per line, Booleans for crossings, unbalanced cycles as lazy rows."""
