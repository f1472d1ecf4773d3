"""Measurements of speed and truth of the simulation."""
