"""One importing process for the tests of a file: starting one takes a second."""

from collections.abc import Iterator

import pytest

from keypush.objects.importing.process import Importer


@pytest.fixture(scope="module")
def importer() -> Iterator[Importer]:
    with Importer() as shared:
        yield shared
