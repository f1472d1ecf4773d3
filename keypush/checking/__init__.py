"""Checks of objects: geometry, mass, and a short simulation of each alone on the table."""
