"""From a closed solid to the mesh that touches: few faces, fine where the object rests."""
