"""Seeds: a stream depends on its four arguments alone, and every one of them counts."""

import subprocess
import sys

from hypothesis import given
from hypothesis import strategies as st

from keypush.seeding import EVALUATION_SEEDS, evaluation_seed, make_generator

keys = st.tuples(
    st.integers(0, 2**53), st.integers(0, 10**6), st.text(max_size=12), st.integers(0, 10**5)
)


def _bytes(seed: int, episode: int, purpose: str, step: int) -> bytes:
    return make_generator(seed, episode, purpose, step).bytes(16)


@given(keys, keys)
def test_same_arguments_same_stream_and_others_another(
    a: tuple[int, int, str, int], b: tuple[int, int, str, int]
) -> None:
    assert _bytes(*a) == _bytes(*a)
    assert (_bytes(*a) == _bytes(*b)) == (a == b)


def test_every_argument_counts() -> None:
    streams = {
        _bytes(seed, episode, purpose, step)
        for seed in (0, 1)
        for episode in (0, 1)
        for purpose in ("goal", "arm")
        for step in (0, 1)
    }
    assert len(streams) == 16


def test_the_stream_is_the_same_in_another_process() -> None:
    code = "from keypush.seeding import make_generator as m; print(m(3, 5, 'goal', 7).bytes(16))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == repr(_bytes(3, 5, "goal", 7))


def test_evaluations_have_seeds_that_no_data_set_has() -> None:
    assert evaluation_seed(0) == EVALUATION_SEEDS
    assert evaluation_seed(EVALUATION_SEEDS - 1) == 2 * EVALUATION_SEEDS - 1
    for seed in (EVALUATION_SEEDS, EVALUATION_SEEDS + 7, 2**53):
        assert evaluation_seed(seed) == seed  # so that a saved scenario repeats
