"""The built-in objects as parameters of tests."""

import pytest

from keypush.objects.catalogue import catalogue_names

FEW = ("block", "mug", "bottle", "candle", "tripod", "l_block", "plate", "elephant")
"""Of every kind one: flat and curved sides, hollow, slender, on feet, bent, flat, organic."""

EVERY_OBJECT = pytest.mark.parametrize("name", catalogue_names())
FEW_OBJECTS = pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in FEW else [pytest.mark.slow])
        for name in catalogue_names()
    ],
)
"""All, of which every run of the tests has the few, and slow ones the others."""
