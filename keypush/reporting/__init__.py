"""Turns the records of evaluations into a page and into Markdown."""
