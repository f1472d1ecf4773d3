"""Statistics over evaluated episodes."""
