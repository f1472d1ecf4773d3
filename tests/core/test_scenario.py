"""Scenarios: every constant has a range, YAML keeps them all, and mistakes are named."""

import dataclasses
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from keypush.errors import UserError
from keypush.scenario import (
    VARIED_FIELDS,
    Scenario,
    dump_scenario,
    load_scenario,
    parse_scenario,
)

NAMES = {"object.name", "predictor.weights"}
"""Words that are checked where they are looked up."""
GOAL = "episode.goal"
"""Checked against the table, by tests of its own."""
Field = dataclasses.Field[Any]


def _fields(config: Any, prefix: str = "") -> Iterator[tuple[str, Field]]:
    for spec in dataclasses.fields(config):
        value = getattr(config, spec.name)
        if dataclasses.is_dataclass(value):
            yield from _fields(value, f"{prefix}{spec.name}.")
        else:
            yield f"{prefix}{spec.name}", spec


FIELDS = dict(_fields(Scenario()))
RANGED = {name: spec for name, spec in FIELDS.items() if "range" in spec.metadata}


def _owner(scenario: Scenario, name: str) -> tuple[Any, str]:
    config: Any = scenario
    *groups, last = name.split(".")
    for group in groups:
        config = getattr(config, group)
    return config, last


def _get(scenario: Scenario, name: str) -> Any:
    return getattr(*_owner(scenario, name))


def _with(name: str, value: Any) -> Scenario:
    """A scenario with one field changed; one entry, if the field is a list.

    The box of start positions is as wide as it may be, so that either corner can move, and
    the lower of two factors as low as it may be, so that the upper one can.
    """
    scenario = Scenario()
    scenario.robot.start_lower, scenario.robot.start_upper = [-math.pi] * 7, [math.pi] * 7
    config, last = _owner(scenario, name)
    if "length" in FIELDS[name].metadata:
        value = [*getattr(config, last)[:-1], value]
    if "ordered" in FIELDS[name].metadata:
        value[0] = FIELDS[name].metadata["range"][0]
    setattr(config, last, value)
    return scenario


@pytest.mark.parametrize("name", FIELDS)
def test_every_field_is_checked(name: str) -> None:
    value = _get(Scenario(), name)
    if name in NAMES | {GOAL} or isinstance(value, bool):
        return
    if isinstance(value, str):
        assert value in FIELDS[name].metadata["allowed"]
    else:
        low, high = FIELDS[name].metadata["range"]
        assert -math.inf < low < high < math.inf
        if isinstance(value, list):
            assert len(value) == FIELDS[name].metadata["length"]


def test_the_defaults_are_allowed() -> None:
    Scenario().validate()


@pytest.mark.parametrize("name", RANGED)
def test_a_number_out_of_range_is_refused_by_name(name: str) -> None:
    low, high = RANGED[name].metadata["range"]
    for allowed in (low, high):
        _with(name, allowed).validate()
    step = 1e-3 * (high - low)
    for wrong in (low - step, high + step, math.nan, math.inf, -math.inf):
        with pytest.raises(UserError, match=rf"^{name} is .*; allowed: .* to .*$"):
            _with(name, wrong).validate()


@pytest.mark.parametrize("name", [n for n, s in RANGED.items() if "length" in s.metadata])
@pytest.mark.parametrize("change", [lambda v: v[1:], lambda v: [*v, 0.0], lambda _: []])
def test_a_list_of_another_length_is_refused_by_name(name: str, change: Any) -> None:
    scenario = Scenario()
    config, last = _owner(scenario, name)
    wrong = change(getattr(config, last))
    setattr(config, last, wrong)
    length = FIELDS[name].metadata["length"]
    with pytest.raises(UserError, match=rf"^{name} has {len(wrong)} entries; allowed: {length}$"):
        scenario.validate()


@pytest.mark.parametrize("name", [n for n, s in FIELDS.items() if "allowed" in s.metadata])
def test_a_word_that_is_no_choice_is_refused_by_name(name: str) -> None:
    allowed = FIELDS[name].metadata["allowed"]
    for word in allowed:
        _with(name, word).validate()
    told = ", ".join([*allowed, *FIELDS[name].metadata.get("form", ())[1:]])
    with pytest.raises(UserError, match=f"^{name} is 'neither'; allowed: {told}$"):
        _with(name, "neither").validate()


@pytest.mark.parametrize(
    "goal",
    [[], [0.1], [0.1, 0.1, 0.1], [math.nan, 0.0], [0.0, math.inf], [0.17, 0.0], [0.0, -0.21]],
)
def test_a_goal_off_the_reachable_part_is_refused(goal: list[float]) -> None:
    with pytest.raises(UserError, match=r"^episode\.goal is \[.*allowed.*0\.16 m .*0\.2 m"):
        _with(GOAL, goal).validate()


def test_the_reachable_part_follows_the_table() -> None:
    parse_scenario("episode: {goal: [0.16, -0.2]}")
    parse_scenario("{episode: {goal: [0.3, 0.0]}, table: {length: 1.0}}")
    with pytest.raises(UserError, match=r"episode\.goal is \[0\.16, -0\.2\]"):
        parse_scenario("{episode: {goal: [0.16, -0.2]}, table: {reachable: 0.5}}")


def _value(spec: Field, default: Any) -> st.SearchStrategy[Any]:
    if "allowed" in spec.metadata:
        return st.sampled_from(spec.metadata["allowed"])
    if "range" not in spec.metadata:
        return st.just(default) if default is None else st.from_type(type(default))
    low, high = spec.metadata["range"]
    if isinstance(default, int):
        return st.integers(low, high)
    number = st.floats(low, high)
    length = spec.metadata.get("length")
    return number if length is None else st.lists(number, min_size=length, max_size=length)


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    scenario = Scenario()
    for name in draw(st.sets(st.sampled_from(sorted(FIELDS)), max_size=8)):
        config, last = _owner(scenario, name)
        setattr(config, last, draw(_value(FIELDS[name], getattr(config, last))))
    robot = scenario.robot
    corners = list(zip(robot.start_lower, robot.start_upper, strict=True))
    robot.start_lower = [min(pair) for pair in corners]
    robot.start_upper = [max(pair) for pair in corners]
    for name, (section, varied) in VARIED_FIELDS.items():
        factors = sorted(getattr(scenario.variation, name))
        value = getattr(getattr(scenario, section), varied)
        low, high = FIELDS[f"{section}.{varied}"].metadata["range"]
        fits = value is None or (low <= value * factors[0] and value * factors[1] <= high)
        setattr(scenario.variation, name, factors if fits else [1.0, 1.0])
    return scenario


@given(scenarios())
def test_yaml_round_trip_keeps_every_bit(scenario: Scenario) -> None:
    assert parse_scenario(dump_scenario(scenario)) == scenario


@given(scenarios(), scenarios())
def test_what_is_written_does_not_depend_on_defaults(scenario: Scenario, other: Scenario) -> None:
    other.episode.goal = [0.0, 0.0]
    assert parse_scenario(dump_scenario(scenario), defaults=other) == scenario


@pytest.mark.parametrize("goal", [None, [0.0, 0.0]])
def test_what_is_written_holds_every_field(goal: list[float] | None) -> None:
    written = yaml.safe_load(dump_scenario(_with(GOAL, goal)))
    flat = {
        f"{group}.{key}" if isinstance(value, dict) else group
        for group, value in written.items()
        for key in (value if isinstance(value, dict) else [""])
    }
    assert flat == set(FIELDS)


def test_what_is_left_out_keeps_the_given_defaults() -> None:
    defaults = parse_scenario("{seed: 7, object: {name: can, mass: 0.3}}")
    before = dump_scenario(defaults)
    scenario = parse_scenario("object: {mass: 0.2}", defaults=defaults)
    assert (scenario.seed, scenario.object.name, scenario.object.mass) == (7, "can", 0.2)
    scenario.robot.joint_damping[0] = 0.0
    assert dump_scenario(defaults) == before


def test_no_two_scenarios_share_a_list() -> None:
    Scenario().robot.base_position[0] = 9.0
    assert Scenario().robot.base_position == [-0.5, 0.0, 0.0]


@pytest.mark.parametrize("name", VARIED_FIELDS)
def test_factors_have_the_lower_one_first(name: str) -> None:
    parse_scenario(f"variation: {{{name}: [0.9, 0.9]}}")
    expected = rf"variation\.{name} is \[1\.1, 0\.9\]; allowed: none below the one before it$"
    with pytest.raises(UserError, match=expected):
        parse_scenario(f"variation: {{{name}: [1.1, 0.9]}}")


@pytest.mark.parametrize("name", VARIED_FIELDS)
def test_factors_keep_the_field_that_they_multiply_in_its_range(name: str) -> None:
    section, varied = VARIED_FIELDS[name]
    low, high = FIELDS[f"{section}.{varied}"].metadata["range"]
    wrong = [(high, [1.0, 1.01])] + ([(low, [0.99, 1.0])] if low > 0 else [])
    for value, factors in wrong:
        parse_scenario(f"{section}: {{{varied}: {value}}}")
        expected = (
            rf"variation\.{name} is .* and {section}\.{varied} is {value:g}; "
            rf"allowed: products from {low:g} to {high:g}$"
        )
        with pytest.raises(UserError, match=expected):
            parse_scenario(
                f"{{{section}: {{{varied}: {value}}}, variation: {{{name}: {factors}}}}}"
            )


def test_a_start_box_whose_corners_are_swapped_is_refused() -> None:
    scenario = Scenario()
    scenario.robot.start_lower[3] = scenario.robot.start_upper[3]
    scenario.validate()
    scenario.robot.start_lower[3] = -1.5
    expected = (
        r"^robot\.start_lower is -1\.5 and robot\.start_upper is -1\.5237 at joint 4; allowed"
    )
    with pytest.raises(UserError, match=expected):
        scenario.validate()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("speed: 3", ["speed is unknown; allowed at the top level: seed, policy, object"]),
        ("1: 2", ["1 is unknown; allowed at the top level: seed"]),
        ("? 'a\n\n  b'\n: 2", ["is unknown; allowed at the top level: seed"]),
        (
            "robot: {stiffnes: 1}",
            ["robot.stiffnes is unknown; allowed in robot: base_", "stiffness"],
        ),
        ("null", ["the top level is null; allowed: a mapping with the fields seed, policy"]),
        ("[]", ["the top level is []; allowed: a mapping"]),
        ("3", ["the top level is 3; allowed: a mapping"]),
        ("robot: null", ["robot is null; allowed: a mapping with the fields base_position"]),
        ("object: 5", ["object is 5; allowed: a mapping with the fields name, size_ratio"]),
        ("seed: 1.5", ["seed is 1.5; allowed: a whole number from 0 to 9007199254740992"]),
        ("seed: .nan", ["seed is nan; allowed: a whole number"]),
        ("seed: true", ["seed is True; allowed: a whole number"]),
        ("seed: 9007199254740993", ["seed is 9007199254740993; allowed: 0 to 9007199254740992"]),
        (f"seed: 1{'0' * 400}", ["seed is 1000", "allowed: 0 to"]),
        (f"seed: 0x{'f' * 9000}", ["seed is a whole number of thousands of digits"]),
        (f"object: {{mass: 1{'0' * 400}}}", ["object.mass is 1000", "a number from 0.001 to 10"]),
        ("object: {mass: abc}", ["object.mass is 'abc'; allowed: a number from 0.001 to 10"]),
        ("object: {mass: .inf}", ["object.mass is inf"]),
        ("object: {mass: 10.00000001}", ["object.mass is 10.00000001; allowed: 0.001 to 10"]),
        ("object: {name: 3}", ["object.name is 3; allowed: a text"]),
        (
            "policy: null",
            ["policy is null; allowed: expert, keypoint, keypoint_no_com, behavior_cloning, "],
        ),
        ("episode: {goal: a}", ["episode.goal is 'a'; allowed: a list of two numbers, or null"]),
        ("episode: {goal: [0.1, a]}", ["episode.goal is [0.1, 'a']; allowed: a list of two"]),
        (
            "episode: {max_steps: 1e3}",
            ["episode.max_steps is '1e3'", "whole number from 1 to 100000"],
        ),
        (
            "robot: {base_position: 3}",
            ["robot.base_position is 3; allowed: 3 numbers from -2 to 2"],
        ),
        ("robot: {base_position: [1, 2]}", ["robot.base_position has 2 entries", "3"]),
        ("simulation: {arm_collision: 3}", ["arm_collision is 3; allowed: true or false"]),
        ("a: b: c", ["line 1"]),
        ("object: {name: 2000-13-01}", ["not readable as YAML"]),
        (
            "noise: {cloud_deviation: 0}\nseed: 1\n\nnoise:\n  cloud_points: 64\n",
            ["mine.yaml: noise is given twice, in lines 1 and 4; allowed: once"],
        ),
        (
            "object:\n  name: mug\n  'name': can\n",
            ["mine.yaml: object.name is given twice, in lines 2 and 3; allowed: once"],
        ),
        ("_a: [{? 'b\n\n  c'\n: 1, ? 'b\n\n  c'\n: 2}]", ["_a.'b\\nc' is given twice, in lines 1"]),
        ("seed: !!python/object:os.system {}", ["python/object"]),
    ],
    ids=lambda value: value[:40] if isinstance(value, str) else "",
)
def test_a_mistake_is_one_line_that_names_file_and_field(
    text: str, words: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(UserError) as caught:
        load_scenario(path)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    for word in words:
        assert word in message


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.dates(),
    lambda inner: st.lists(inner, max_size=8) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=8,
)


@given(st.sampled_from([*FIELDS, "object", "robot", "episode"]), VALUES)
def test_whatever_a_field_holds_is_read_or_refused_by_its_name(name: str, value: Any) -> None:
    data = value
    for part in reversed(name.split(".")):
        data = {part: data}
    message = ""
    try:
        parse_scenario(yaml.safe_dump(data))
    except UserError as error:
        message = str(error)
    # One corner of the box of starts may be at odds with the other.
    pattern = rf"scenario: (robot\.start_lower is \S+ and )?{re.escape(name)}"
    assert not message or re.match(pattern, message)
    assert len(message.splitlines()) <= 1


@pytest.mark.parametrize("text", ["0.2", "2e-1", "'0.2'", "+.2", "1_0.0e-2"])
def test_a_number_can_be_written_in_more_than_one_way(text: str) -> None:
    expected = 0.1 if "_" in text else 0.2
    assert parse_scenario(f"object: {{mass: {text}}}").object.mass == expected


def test_a_field_may_take_the_place_of_a_templates() -> None:
    text = "{_light: &light {mass: 0.02, friction: 0.5}, object: {<<: *light, mass: 0.3}}"
    assert parse_scenario(text).object.mass == 0.3
    assert parse_scenario(text).object.friction == 0.5


def test_a_template_for_aliases_is_no_field() -> None:
    scenario = parse_scenario("{_light: &light {mass: 0.02}, object: *light}")
    assert scenario.object.mass == 0.02


@pytest.mark.parametrize("text", ["", "# seed: 1\n", "{}"])
def test_an_empty_file_is_the_defaults(text: str, tmp_path: Path) -> None:
    path = tmp_path / "empty.yaml"
    path.write_text(text)
    assert load_scenario(path) == Scenario()
    with pytest.raises(UserError, match=r"absent\.yaml: cannot be read"):
        load_scenario(tmp_path / "absent.yaml")
