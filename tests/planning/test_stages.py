"""The stages of a push, with a tool that follows its reference exactly, and with others."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from keypush.control.differential_ik import damped_least_squares
from keypush.planning.finger import lowest_corner
from keypush.planning.plan_state import PlanState, PushObservation, Stage
from keypush.planning.posture import Posture
from keypush.planning.push_frame import left_of, rotation_vector, tool_rotation
from keypush.planning.stages import PushStages
from keypush.scenario import TableConfig
from tests.control.arm import ARM, CLIP, Array, starts, vectors
from tests.planning.ideal_tool import (
    CONFIG,
    CONTROL,
    PERIOD,
    STAGES,
    Change,
    IdealTool,
    Step,
    missed_by,
    reset_by,
)

CONTACT = np.array([0.02, 0.05, 0.012])
GOALS = [np.array(g) for g in ([0.15, 0.05], [0.02, -0.15], [-0.1, -0.05], [0.12, 0.18])]
ORDER = [Stage.RISE, Stage.APPROACH, Stage.DESCEND, Stage.SETTLE, Stage.PUSH]


@pytest.fixture(scope="module", params=range(len(GOALS)))
def episode(request: pytest.FixtureRequest) -> list[Step]:
    """From the start until the tool has pushed for ten steps."""
    tool = IdealTool(CONTACT, GOALS[request.param])
    steps = tool.run(Stage.PUSH)
    return steps + [tool.step() for _ in range(10)]


def test_the_stages_follow_their_order(episode: list[Step]) -> None:
    stages = [step.before.stage for step in episode] + [episode[-1].after.stage]
    assert [stage for stage, _ in itertools.groupby(stages)] == ORDER


def test_the_reference_keeps_its_speeds(episode: list[Step]) -> None:
    for step in episode:
        pushing = step.after.stage == Stage.PUSH
        speed = CONFIG.push_speed if pushing else CONFIG.free_speed
        moved = np.linalg.norm(step.after.p_WR - step.before.p_WR)
        assert moved <= speed * PERIOD + 1e-9
        turned = np.linalg.norm(rotation_vector(step.before.R_WR, step.after.R_WR))
        assert turned <= CONFIG.turn_rate * PERIOD + 1e-9


def test_the_tool_pushes_straight_at_the_goal(episode: list[Step]) -> None:
    pushes = [step for step in episode if step.before.stage == Stage.PUSH]
    assert len(pushes) >= 10
    for step in pushes:
        moved = step.after.p_WR - step.before.p_WR
        # A tool that is above its height sinks first: it would lift the object.
        low = step.seen.X_WE.translation()[2] <= CONFIG.tool_height
        speed = CONFIG.touch_speed if step.after.touching else CONFIG.push_speed
        assert moved @ step.seen.d_W > (0.8 if low else 0.0) * speed * PERIOD - 1e-9
        off_line = (step.after.p_WR - CONTACT) @ left_of(step.seen.d_W)
        assert abs(off_line) < CONFIG.reapproach_error
        R_WE = tool_rotation(step.seen.d_W, step.after.posture.pitch, step.after.posture.side)
        assert np.linalg.norm(rotation_vector(step.after.R_WR, R_WE)) < 0.2
    heights = [step.after.p_WR[2] for step in pushes]
    assert max(heights) < CONFIG.tool_height + 0.01
    assert min(heights) > 0.0


def test_the_tool_comes_down_behind_the_contact_and_nowhere_else(episode: list[Step]) -> None:
    for step in episode:
        offset = step.after.p_WR - step.seen.p_WK
        if step.after.stage in (Stage.RISE, Stage.APPROACH):
            assert step.after.p_WR[2] > 0.04
        elif step.after.stage in (Stage.DESCEND, Stage.SETTLE):
            assert offset @ step.seen.d_W < -0.5 * CONFIG.approach_margin
            assert abs(offset @ left_of(step.seen.d_W)) < 0.03


def test_the_action_moves_the_arm_towards_the_reference(episode: list[Step]) -> None:
    """What the action makes of the arm, by the controller's rule, is the wanted motion."""
    followed = 0
    for step in episode:
        X_WE, after = step.seen.X_WE, step.after
        offset = after.p_WR - X_WE.translation()
        wanted = np.concatenate([offset, rotation_vector(X_WE.rotation(), after.R_WR)])
        wanted *= CONFIG.tracking_gain
        assert np.all(np.abs(wanted) <= CLIP + 1e-9)
        J = ARM.jacobian(step.seen.q)
        moved = J @ damped_least_squares(J, step.action, CONTROL.damping)
        assert np.linalg.norm(moved) <= np.linalg.norm(wanted) + 1e-9
        followed += bool(np.linalg.norm(moved - wanted) < 0.15 * np.linalg.norm(wanted) + 1e-3)
    assert followed > 0.8 * len(episode)


def _pushing() -> IdealTool:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.PUSH)
    tool.step()
    return tool


@pytest.mark.parametrize("stage", [Stage.RISE, Stage.APPROACH, Stage.DESCEND, Stage.PUSH])
def test_a_halt_stops_the_reference_for_good(stage: Stage) -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(stage)
    p_WR, R_WR = tool.state.p_WR, tool.state.R_WR
    step = tool.step(lambda _, seen: replace(seen, halted=True))
    assert step.after.stage == Stage.HALTED
    steps = [step, *(tool.step() for _ in range(3))]
    for step in steps:
        assert step.after.stage == Stage.HALTED
        np.testing.assert_array_equal(step.after.p_WR, p_WR)
        assert step.after.R_WR.IsExactlyEqualTo(R_WR)
    np.testing.assert_allclose(steps[-1].action, np.zeros(6), atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_missed_contact_makes_the_tool_let_go_and_come_again(sign: float) -> None:
    tool = _pushing()
    miss = missed_by(sign * 3 * CONFIG.reapproach_error)
    for _ in range(20):
        step = tool.step(miss)
        if step.after.stage == Stage.RETREAT:
            break
    else:
        pytest.fail("the tool did not let go")
    p_WE, d_W = step.seen.X_WE.translation(), step.seen.d_W
    assert (step.after.p_WT - p_WE) @ d_W < -0.5 * CONFIG.approach_margin
    assert step.after.p_WT[2] < 0.03
    tool.run(Stage.PUSH)


def held_up(state: PlanState, seen: PushObservation) -> PushObservation:
    """The tool is a centimetre too high, whatever the planner does."""
    del state
    p_WE = seen.X_WE.translation()
    high = np.array([p_WE[0], p_WE[1], CONFIG.tool_height + 0.01])
    return replace(seen, X_WE=RigidTransform(seen.X_WE.rotation(), high))


def test_a_tool_that_stays_too_high_to_push_lets_go_and_comes_again() -> None:
    tool = _pushing()
    steps = []
    while tool.state.stage == Stage.PUSH:
        steps.append(tool.step(held_up))
        assert len(steps) < 30
        if tool.state.stage == Stage.PUSH:
            lead = steps[-1].after.p_WR - steps[-1].seen.X_WE.translation()
            np.testing.assert_allclose(lead[:2], 0.0, atol=1e-12)
            assert lead[2] < 0
    assert len(steps) > 5
    assert tool.state.stage == Stage.RETREAT
    tool.run(Stage.PUSH)


def test_a_tool_that_was_too_high_for_a_moment_goes_on() -> None:
    tool = _pushing()
    while tool.state.touching < 13:  # at full speed
        tool.step()
    for _ in range(3):
        for _ in range(5):
            tool.step(held_up)
        for _ in range(5):
            assert tool.step().after.stage == Stage.PUSH


def at(x: float) -> Change:
    """Puts the tool at its height at (x, 0)."""

    def change(_: PlanState, seen: PushObservation) -> PushObservation:
        p_WE = np.array([x, 0.0, CONFIG.tool_height])
        return replace(seen, X_WE=RigidTransform(seen.X_WE.rotation(), p_WE))

    return change


def test_a_push_that_makes_no_way_lets_go_and_comes_again() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.PUSH)
    stuck = replace(tool.see(), distance=0.1)
    state = tool.state
    stages = []
    for _ in range(40):
        state = STAGES.advance(state, stuck)
        stages.append(state.stage)
    assert stages.index(Stage.RETREAT) == 30


def _tilted(degrees: float) -> Change:
    return lambda _, seen: replace(seen, tilt=float(np.deg2rad(degrees)))


def _forward(step: Step) -> float:
    return float((step.after.p_WR - step.seen.X_WE.translation()) @ step.seen.d_W)


def test_a_push_gives_way_while_the_object_tilts_more_and_more() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.PUSH)
    assert _forward(tool.step(_tilted(0.9))) > 0.0
    assert _forward(tool.step(_tilted(1.2))) < 0.0
    assert _forward(tool.step(_tilted(0.8))) < 0.0
    assert _forward(tool.step(_tilted(0.5))) > 0.0


def test_a_push_goes_on_where_the_tilt_does_not_grow() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.PUSH)
    tool.step(_tilted(1.2))
    steps = [tool.step(_tilted(1.2)) for _ in range(12)]
    assert [_forward(step) > 0.0 for step in steps] == [False] * 5 + [True] * 7
    assert {step.after.stage for step in steps} == {Stage.PUSH}


def test_a_push_bears_more_tilt_each_time_it_gave_way() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.PUSH)
    for waits, tilt in ((1, 1.1), (1, 1.1), (2, 1.3), (2, 1.3), (3, 1.5)):
        tool.step(_tilted(0.0))
        tool.step(_tilted(tilt))
        assert tool.state.waits == waits
        tool.step(_tilted(0.0))


def _speed(step: Step) -> float:
    return float(np.linalg.norm(step.after.p_WR - step.before.p_WR)) / PERIOD


def _at_height(_: PlanState, seen: PushObservation) -> PushObservation:
    """The tool is where the press is nothing, so that the reference moves across alone."""
    p_WE = seen.X_WE.translation().copy()
    p_WE[2] = CONFIG.tool_height - 0.0035
    return replace(seen, X_WE=RigidTransform(seen.X_WE.rotation(), p_WE))


def test_a_push_is_slow_where_it_may_touch_and_reaches_its_speed_after_that() -> None:
    tool = IdealTool(CONTACT, GOALS[2])
    tool.run(Stage.PUSH)
    steps = [tool.step(_at_height) for _ in range(25)]
    gaps = [(s.seen.p_WK - s.seen.X_WE.translation()) @ s.seen.d_W for s in steps]
    first = next(i for i, gap in enumerate(gaps) if gap < 0.025)
    assert 0 < first < 10
    near = [_speed(step) for step in steps[first : first + 8]]
    np.testing.assert_allclose(near, CONFIG.touch_speed, rtol=1e-6)
    gained = [_speed(step) for step in steps[first + 8 : first + 13]]
    assert np.all(np.diff(gained) > 0.0)
    assert gained[-1] == pytest.approx(CONFIG.push_speed)


def test_a_push_that_gave_way_touches_slowly_again() -> None:
    tool = IdealTool(CONTACT, GOALS[2])
    tool.run(Stage.PUSH)
    while tool.state.touching < 20:
        tool.step(_at_height)
    tool.step(_tilted(1.2))
    assert (tool.state.waiting > 0, tool.state.touching) == (True, 0)
    while tool.state.waiting or not tool.state.touching:
        tool.step(_at_height)
    assert _speed(tool.step(_at_height)) == pytest.approx(CONFIG.touch_speed)


def test_a_push_that_is_slower_than_a_touch_keeps_its_speed() -> None:
    config = replace(CONFIG, push_speed=0.01)
    stages = PushStages(ARM, config, CONTROL, TableConfig(), PERIOD)
    tool = IdealTool(CONTACT, GOALS[2])
    tool.run(Stage.PUSH)
    while not tool.state.touching:
        tool.step(_at_height)
    seen = _at_height(tool.state, tool.see())
    after = stages.advance(tool.state, seen)
    moved = (after.p_WR - tool.state.p_WR)[:2]
    assert np.linalg.norm(moved) == pytest.approx(0.01 * PERIOD, rel=1e-3)


def test_the_press_has_no_jump() -> None:
    """A press that is switched makes a tool hop that slides on the table."""
    tool = _pushing()
    X_WE = tool.X_WE
    heights = CONFIG.tool_height + np.linspace(-0.01, 0.01, 401)
    presses = []
    for height in heights:
        p_WE = np.array([*X_WE.translation()[:2], height])
        seen = replace(tool.see(), X_WE=RigidTransform(X_WE.rotation(), p_WE))
        presses.append(STAGES.advance(tool.state, seen).p_WR[2] - height)
    assert np.max(np.abs(np.diff(presses))) < 2e-4
    assert presses[0] > 0.0 > presses[-1]


def test_beside_the_table_a_push_keeps_its_height_instead_of_pressing_down() -> None:
    edge = TableConfig().length / 2
    over, off = (_pushing().step(at(x)).after.p_WR[2] for x in (edge - 0.03, edge + 0.03))
    assert over < CONFIG.tool_height - 0.002
    assert off == pytest.approx(CONFIG.tool_height, abs=1e-4)


def test_a_steeper_tool_pushes_with_its_finger_as_low_as_another() -> None:
    def finger(pitch: float) -> float:
        tool = _pushing()
        posture = replace(tool.state.posture, pitch=pitch)
        tool.state = replace(tool.state, posture=posture, stage=Stage.DESCEND)
        tool.run(Stage.PUSH)
        return float(tool.X_WE.translation()[2]) - lowest_corner(pitch, np.pi / 2)

    assert finger(np.deg2rad(75.0)) == pytest.approx(finger(np.deg2rad(60.0)), abs=5e-4)


def lowered(state: PlanState, seen: PushObservation) -> PushObservation:
    """The tool is a centimetre too low."""
    del state
    low = seen.X_WE.translation() - [0.0, 0.0, 0.01]
    return replace(seen, X_WE=RigidTransform(seen.X_WE.rotation(), low))


def test_a_push_begins_with_the_tool_at_rest_at_its_height() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.SETTLE)
    # It passes by at its height once, and is off again.
    assert tool.step().after.stage == Stage.SETTLE
    assert tool.step(lowered).after.stage == Stage.SETTLE
    assert tool.step().after.stage == Stage.SETTLE
    assert tool.step().after.stage == Stage.PUSH


def test_a_push_that_would_need_a_much_steeper_tool_is_out_of_reach() -> None:
    near = IdealTool(CONTACT, GOALS[0]).see()
    assert STAGES.reaches(near)
    # Towards the robot, from the far edge.
    far = replace(
        near, p_WK=np.array([0.19, -0.16, 0.012]), d_W=np.array([-1.0, 0.0, 0.0]), distance=0.25
    )
    assert not STAGES.reaches(far)


def test_single_steps_beside_the_contact_are_no_miss() -> None:
    tool = _pushing()
    for _ in range(8):
        tool.step(missed_by(3 * CONFIG.reapproach_error))
        assert tool.step().after.stage == Stage.PUSH


@pytest.mark.parametrize("offset", [(-0.05, 0.0), (-0.06, 0.04), (-0.04, -0.04)])
def test_a_reset_retreats_to_its_offset_and_comes_again(offset: tuple[float, float]) -> None:
    tool = _pushing()
    step = tool.step(reset_by(*offset))
    assert step.after.stage == Stage.RETREAT
    forward, left = offset
    expected = step.seen.p_WK + forward * step.seen.d_W + left * left_of(step.seen.d_W)
    np.testing.assert_allclose(step.after.p_WT[:2], expected[:2], atol=1e-12)
    arrived = []
    while tool.state.stage == Stage.RETREAT:
        arrived.append(tool.step())
        assert len(arrived) < 50
    off = arrived[-1].seen.X_WE.translation() - step.after.p_WT
    assert np.linalg.norm(off) <= 0.02
    tool.run(Stage.PUSH)


def test_a_reset_lets_go_of_the_object_wherever_its_noise_puts_it() -> None:
    tool = _pushing()
    step = tool.step(reset_by(0.0, 0.05))
    behind = (step.after.p_WT - step.seen.p_WK) @ step.seen.d_W
    assert behind < -0.02


def test_a_reset_is_for_pushing_only() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.APPROACH)
    assert tool.step(reset_by(-0.05, 0.0)).after.stage == Stage.APPROACH


def test_advance_is_a_pure_function() -> None:
    tool = _pushing()
    state, seen = tool.state, tool.see()
    p_WR, p_WK, q = state.p_WR.copy(), seen.p_WK.copy(), seen.q.copy()
    first = STAGES.advance(state, seen)
    STAGES.advance(first, replace(seen, p_WK=seen.p_WK + 0.01))
    second = STAGES.advance(state, seen)
    assert first.to_vector().tobytes() == second.to_vector().tobytes()
    action = STAGES.action(first, seen)
    assert STAGES.action(first, seen).tobytes() == action.tobytes()
    for now, then in ((state.p_WR, p_WR), (seen.p_WK, p_WK), (seen.q, q)):
        np.testing.assert_array_equal(now, then)


states = st.builds(
    PlanState,
    stage=st.sampled_from([s for s in Stage if s != Stage.HALTED]),
    steps=st.integers(0, 300),
    strikes=st.integers(0, 3),
    barred=st.booleans(),
    jammed=st.integers(0, 20),
    stalled=st.integers(0, 40),
    waiting=st.integers(0, 6),
    waits=st.integers(0, 20),
    touching=st.integers(0, 300),
    posture=st.builds(
        Posture, st.sampled_from([1, -1]), st.just(np.pi / 3), st.just(CONFIG.approach_height)
    ),
    R_WR=starts.map(lambda q: ARM.tool_pose(q).rotation()),
    p_WR=vectors(3, -0.3, 0.3),
    p_WT=vectors(3, -0.3, 0.3),
    nearest=st.floats(0.0, 0.5),
    tilt=st.floats(0.0, 0.2),
)


@given(states)
def test_the_state_survives_its_way_through_a_context(state: PlanState) -> None:
    packed = state.to_vector()
    assert packed.shape == (PlanState.SIZE,)
    again = PlanState.from_vector(packed)
    for name in (
        "stage",
        "steps",
        "strikes",
        "barred",
        "jammed",
        "stalled",
        "waiting",
        "waits",
        "touching",
        "posture",
        "nearest",
        "tilt",
    ):
        assert getattr(again, name) == getattr(state, name)
    assert isinstance(again.stage, Stage)
    np.testing.assert_allclose(again.R_WR.matrix(), state.R_WR.matrix(), atol=1e-12)
    np.testing.assert_array_equal(again.p_WR, state.p_WR)
    np.testing.assert_array_equal(again.p_WT, state.p_WT)


def test_the_reference_starts_at_the_tool() -> None:
    X_WE = RigidTransform(RotationMatrix.MakeYRotation(0.3), np.array([0.1, 0.2, 0.3]))
    state = PlanState.start(X_WE)
    assert state.stage == Stage.RISE
    np.testing.assert_array_equal(state.p_WR, X_WE.translation())
    assert state.R_WR.IsExactlyEqualTo(X_WE.rotation())


@settings(max_examples=50)
@given(states, starts, vectors(2, -0.15, 0.15), st.floats(-np.pi, np.pi))
def test_the_reference_never_runs_away_from_the_tool(
    state: PlanState, q: Array, xy: Array, angle: float
) -> None:
    """Wherever tool and reference are: no action is clipped, and so none is bent."""
    d_W = np.array([np.cos(angle), np.sin(angle), 0.0])
    seen = PushObservation(q, ARM.tool_pose(q), np.array([*xy, 0.012]), d_W, 0.1)
    after = STAGES.advance(state, seen)
    lead = np.abs(after.p_WR - seen.X_WE.translation())
    assert np.all(CONFIG.tracking_gain * lead <= CONTROL.max_translation + 1e-9)
    if after.stage != Stage.RETREAT:  # which keeps the orientation that it began with
        turn = np.linalg.norm(rotation_vector(seen.X_WE.rotation(), after.R_WR))
        assert CONFIG.tracking_gain * turn <= CONTROL.max_rotation + 1e-9
    assert np.all(np.isfinite(STAGES.action(after, seen)))


def test_a_tool_that_is_held_up_is_waited_for() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.APPROACH)
    X_WE, q = tool.X_WE, tool.q
    for _ in range(30):
        step = tool.step()
        tool.X_WE, tool.q = X_WE, q
    assert step.after.stage == Stage.APPROACH
    assert np.all(np.abs(step.after.p_WR - X_WE.translation()) <= CONTROL.max_translation)


def kept_at(X_WE: RigidTransform) -> Change:
    """The arm stays where it is, whatever the planner does."""
    return lambda _, seen: replace(seen, X_WE=X_WE)


def test_an_arm_that_cannot_rise_goes_on_sideways() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    low = RigidTransform(tool.X_WE.rotation(), np.array([-0.1, 0.0, CONFIG.approach_height - 0.05]))
    for _ in range(30):
        tool.step(kept_at(low))
        if tool.state.stage == Stage.APPROACH:
            return
    pytest.fail("the tool waits for ever")


def test_a_barred_way_is_tried_from_the_other_side() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.APPROACH)
    first, X_WE = tool.state.posture.side, tool.X_WE
    while tool.state.stage == Stage.APPROACH:
        tool.step(kept_at(X_WE))
    assert tool.state.stage == Stage.RISE
    tool.run(Stage.APPROACH)
    assert tool.state.posture.side == -first


def test_a_tool_that_is_held_off_from_where_it_should_settle_does_not_push() -> None:
    tool = IdealTool(CONTACT, GOALS[0])
    tool.run(Stage.SETTLE)
    off = RigidTransform(tool.X_WE.rotation(), tool.X_WE.translation() + np.array([0, 0, 0.015]))
    while tool.state.stage == Stage.SETTLE:
        tool.step(kept_at(off))
    assert tool.state.stage == Stage.RISE
