"""Generators of the catalogue's shapes: closed meshes of parametric things, from booleans."""
