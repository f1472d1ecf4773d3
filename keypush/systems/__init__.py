"""Drake systems; one file each. Nothing here knows how they are wired."""
