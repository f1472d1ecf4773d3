"""Objects that are pushed: catalogue, meshes, mass properties, and how they enter a plant."""
