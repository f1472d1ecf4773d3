"""Processes: all are used, none is left."""

import multiprocessing

import pytest

from keypush.errors import UserError
from keypush.learning.ablation.pool import run_all, worker_pool
from tests.learning.ablation.pool_tasks import be_killed, complain, square, wait


@pytest.mark.parametrize("workers", [1, 3])
def test_every_task_is_answered_by_a_silent_process(workers: int) -> None:
    with worker_pool(workers) as pool:
        for numbers in (range(6), range(6, 8), range(0)):
            found = dict(run_all(pool, square, numbers))
            assert found == {number: (number**2, True) for number in numbers}
        assert len(multiprocessing.active_children()) <= workers
    assert not multiprocessing.active_children()


def test_a_killed_process_is_told_on_one_line() -> None:
    message = r"ended by the system.* are kept; allowed: fewer"
    with pytest.raises(UserError, match=message) as error, worker_pool(1) as pool:
        list(run_all(pool, be_killed, [1]))
    assert "\n" not in str(error.value)
    assert not multiprocessing.active_children()


def test_a_mistake_of_the_users_arrives_as_one() -> None:
    with pytest.raises(UserError, match=r"^number is 7; allowed: none$"), worker_pool(1) as pool:
        list(run_all(pool, complain, [7]))


def test_who_leaves_early_leaves_no_process() -> None:
    with worker_pool(2) as pool:
        assert next(run_all(pool, wait, [0, 1])) == (0, 0)
    assert not multiprocessing.active_children()
