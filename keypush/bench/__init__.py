"""Measurements of speed, and of truth: simulation, policies, networks, training."""
