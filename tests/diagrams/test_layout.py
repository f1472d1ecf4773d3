"""The layout of the diagram's picture."""

from hypothesis import given
from hypothesis import strategies as st

from diagrams.layout import arrange

graphs = st.integers(1, 8).flatmap(
    lambda n: st.tuples(
        st.just(n), st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=20)
    )
)


@given(graphs)
def test_data_flows_to_the_right_but_for_loops(graph: tuple[int, list[tuple[int, int]]]) -> None:
    count, edges = graph
    layout = arrange(count, edges)
    column = {system: c for c, members in enumerate(layout.columns) for system in members}
    assert sorted(column) == list(range(count))
    for source, sink in edges:
        if (source, sink) not in layout.backward:
            assert column[source] < column[sink]


def test_only_what_closes_a_loop_runs_backward() -> None:
    assert arrange(3, [(0, 1), (1, 2), (0, 2)]).backward == frozenset()
    assert arrange(3, [(0, 1), (1, 2), (2, 1)]).backward == {(2, 1)}


def test_a_loop_is_cut_where_fewest_wires_lead_back() -> None:
    policy_feeds_station = [(1, 2), (2, 1), (2, 1), (2, 3), (3, 1)]
    assert arrange(4, [(0, 1), *policy_feeds_station]).backward == {(1, 2)}


def test_wires_do_not_cross_when_they_need_not() -> None:
    assert arrange(4, [(0, 3), (1, 2)]).columns == [[0, 1], [3, 2]]
