"""Geometry and stage logic of a push; pure functions, no Drake systems."""
