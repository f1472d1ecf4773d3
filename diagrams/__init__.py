"""Functions that wire keypush's systems into diagrams, and their scenario YAML.

Builders are spelled as in Drake (`MakePushStation`), everything else as in PEP 8.
"""
