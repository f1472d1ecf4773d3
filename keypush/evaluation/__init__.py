"""Evaluated episodes: run under conditions, recorded, summarised, told."""
