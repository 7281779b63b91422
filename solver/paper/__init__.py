"""Formulation "paper": the program as the paper prints it."""
