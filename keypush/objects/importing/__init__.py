"""From a mesh file that somebody made to a closed solid.

    import_mesh(path: Path, time_limit: float = 60.0) -> ImportedMesh      (process.py)

    ImportedMesh: solid (trimesh.Trimesh), colour, sha256, notes           (result.py)

`read.py` reads the file, `clean.py` tidies its faces, `repair.py` closes them, `wrap.py` makes a
solid of what has no inside, and `process.py` runs all of it in a process that may hang or crash.
Units and frame are those of the file.
"""
