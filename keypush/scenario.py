"""The scenario: every constant of the task, as dataclasses that YAML and the command line share.

Units are SI (m, s, kg, N, rad) unless a name ends in `_deg`. Frames: W world (centre of the
table top, z up, x away from the robot), B robot base, E tool tip, O object.
"""

import math
from dataclasses import dataclass, field, fields
from pathlib import Path

from pydrake.common.yaml import yaml_dump_typed, yaml_load_typed

from keypush.checked_fields import choice, factors, number, vector
from keypush.errors import UserError, one_line
from keypush.policies import OWN_POLICY, POLICIES, SHIPPED, is_own_policy
from keypush.scenario_check import LARGEST_SEED, SURFACE_POINTS, check_values, check_yaml
from keypush.yaml_text import parse_yaml

INTEGRATORS = ("cenic", "discrete")
VARIED_FIELDS = {
    "size": ("object", "size_ratio"),
    "mass": ("object", "mass"),
    "object_friction": ("object", "friction"),
    "table_friction": ("table", "friction"),
    "gripper_friction": ("robot", "gripper_friction"),
}
"""Section and name of the field that each of the factors in `variation` multiplies."""


@dataclass(kw_only=True)
class ObjectConfig:
    """The object that is pushed."""

    name: str = "mug"
    """Name of a built-in object, or of one that was added."""
    size_ratio: float = number(1.0, 0.25, 3.0)
    """Size relative to the object's own; the sphere about a built-in one is 0.10 m across."""
    mass: float | None = number(None, 0.001, 10.0)
    """Mass in kg; the object's own, 0.1 for a built-in one, when null."""
    friction: float = number(0.7, 0.0, 3.0)
    """Coulomb coefficient; Drake combines a pair as 2ab/(a+b)."""


@dataclass(kw_only=True)
class TableConfig:
    """The table: a box whose top face is centred on Wo."""

    length: float = number(0.40, 0.1, 5.0)
    """Extent along Wx."""
    width: float = number(0.50, 0.1, 5.0)
    """Extent along Wy."""
    height: float = number(0.40, 0.05, 2.0)
    """Distance from the floor to the table top."""
    friction: float = number(0.4, 0.0, 3.0)
    """Coulomb coefficient."""
    reachable: float = number(0.8, 0.1, 1.0)
    """Share of each half-extent in which objects and goals are placed."""


@dataclass(kw_only=True)
class RobotConfig:
    """The Panda arm."""

    base_position: list[float] = vector([-0.5, 0.0, 0.0], -2.0, 2.0)
    """p_WBo_W."""
    gripper_friction: float = number(1.0, 0.0, 3.0)
    """Coulomb coefficient of palm, fingers, wrist and forearm."""
    stiffness: float = number(200.0, 1.0, 5000.0)
    """k_p of every joint, Nm/rad."""
    damping_ratio: float = number(1.0, 0.0, 10.0)
    """rho; k_d = rho sqrt(k_p)."""
    joint_damping: list[float] = vector([2.12, 2.3, 1.29, 2.8, 0.291, 0.3, 0.46], 0.0, 100.0)
    """Viscous damping, Nms/rad."""
    reflected_inertia: list[float] = vector([0.61, 0.61, 0.46, 0.46, 0.21, 0.21, 0.21], 0.0, 10.0)
    """Rotor inertia seen at the joint, kg m^2."""
    start_lower: list[float] = vector(
        [-0.3, -0.4636, -0.2, -2.7432, -0.3335, 1.5269, -math.pi / 2], -math.pi, math.pi
    )
    """Lower corner of the box of start positions, rad."""
    start_upper: list[float] = vector(
        [0.3, 0.5432, 0.2, -1.5237, 0.3335, 2.5744, math.pi / 2], -math.pi, math.pi
    )
    """Upper corner of the box of start positions, rad."""
    start_deviation: float = number(0.03, 0.0, 1.0)
    """Standard deviation added to every start position, rad."""
    start_tool_height: float = number(0.05, 0.0, 1.0)
    """Least height of the tool above the table at the start."""
    start_object_distance: float = number(0.12, 0.0, 1.0)
    """Least distance of the tool from Oo at the start."""


@dataclass(kw_only=True)
class EpisodeConfig:
    """How an episode begins, what counts as success and when it ends."""

    policy_period: float = number(0.1, 0.01, 1.0)
    """Time of one policy step."""
    max_steps: int = field(default=300, metadata={"range": (1, 100_000)})
    """Policy steps after which the episode has timed out."""
    goal: list[float] | None = None
    """Goal xy in W; drawn at random when null."""
    goal_min_distance: float = number(0.1, 0.0, 2.0)
    """Least distance of the goal from the object's start, xy."""
    goal_radius: float = number(0.05, 0.001, 1.0)
    """Success radius about the goal, xy."""
    max_tilt_deg: float = number(15.0, 0.1, 180.0)
    """Upright means tilted by less than this."""
    max_height_change: float = number(0.02, 0.0001, 1.0)
    """Upright means that COM and reference points moved up or down by less than this."""
    settle_time: float = number(1.0, 0.0, 10.0)
    """Time from the tool's stop to the test of `settled_success`."""


@dataclass(kw_only=True)
class NoiseConfig:
    """Noise of sensors and actuators."""

    cloud_points: int = field(default=512, metadata={"range": (16, SURFACE_POINTS)})
    """Points of the cloud."""
    cloud_deviation: float = number(0.005, 0.0, 0.1)
    """Standard deviation of every coordinate of the cloud."""
    torque_deviation: float = number(0.03, 0.0, 10.0)
    """Standard deviation of every joint's torque, Nm, redrawn each policy step."""


@dataclass(kw_only=True)
class SimulationConfig:
    """The integrator and the contact model."""

    integrator: str = choice("cenic", INTEGRATORS)
    """Error-controlled CENIC, or the discrete `lagged` model as the reference."""
    accuracy: float = number(1e-3, 1e-8, 1.0)
    """CENIC's accuracy."""
    max_step: float = number(0.1, 1e-5, 0.1)
    """CENIC's longest step."""
    discrete_period: float = number(1e-3, 1e-5, 0.02)
    """Time step of the discrete model."""
    hydroelastic_modulus: float = number(1e7, 1e3, 1e10)
    """Of the gripper, Pa."""
    table_modulus: float = number(5e7, 1e3, 1e11)
    """Of the table, Pa; an object on a softer one tips well inside its support polygon."""
    table_margin: float = number(1e-3, 0.0, 0.01)
    """Distance at which contact with the table is foreseen, m; without it long steps hop."""
    dissipation: float = number(50.0, 0.0, 1e4)
    """Hunt-Crossley dissipation, s/m."""
    arm_collision: bool = True
    """Whether wrist and forearm can touch table and object."""


@dataclass(kw_only=True)
class ControlConfig:
    """Tool action and differential inverse kinematics."""

    max_translation: float = number(0.06, 0.001, 1.0)
    """Clip of the action's translation per axis and policy step."""
    max_rotation: float = number(0.1, 0.001, 3.0)
    """Clip of the action's axis-angle per axis and policy step, rad."""
    damping: float = number(0.01, 1e-6, 1.0)
    """lambda^2 of the damped least squares."""


@dataclass(kw_only=True)
class PlannerConfig:
    """The stages that take the tool behind the contact and push."""

    pitch_deg: float = number(60.0, 10.0, 90.0)
    """Angle of the tool's axis below the table plane."""
    wrist_yaw_deg: float = number(90.0, 0.0, 90.0)
    """Angle of the finger row out of the plane of the push; the thesis has 0."""
    tool_height: float = number(0.015, 0.0, 0.2)
    """Height of the tool tip while it pushes."""
    approach_height: float = number(0.18, 0.02, 0.5)
    """Height of the tool tip on its way to the point above-behind."""
    approach_margin: float = number(0.04, 0.0, 0.2)
    """Distance behind the contact at which the tool comes down."""
    push_speed: float = number(0.065, 0.001, 0.6)
    """Speed of the tool while it pushes, m/s."""
    touch_speed: float = number(0.02, 0.001, 0.6)
    """Speed of the tool where it may first touch the object, m/s; a slower push keeps its own."""
    free_speed: float = number(0.30, 0.01, 1.0)
    """Speed of the tool in free motion, m/s."""
    turn_rate: float = number(0.6, 0.01, 3.0)
    """Angular speed of the tool, rad/s."""
    tracking_gain: float = number(1.4, 0.1, 5.0)
    """Action per error of the tool; above 1 because one action is only partly reached."""
    lateral_gain: float = number(1.0, 0.0, 5.0)
    """Share of the lateral error that one centimetre of pushing takes away."""
    reaim: bool = True
    """Whether contact and direction follow the object during a push, or stay as it began."""
    reapproach_error: float = number(0.015, 0.001, 0.2)
    """Lateral error beyond which the tool lets go and comes again."""
    wait_tilt_deg: float = number(1.0, 0.0, 90.0)
    """Tilt of the object from which a push gives way while it grows; 90 is never."""
    reset_period: int = field(default=0, metadata={"range": (0, 100_000)})
    """Policy steps between two resets of the expert (0: never); the thesis has 20."""
    reset_retreat: float = number(0.05, 0.0, 0.3)
    """How far behind the contact the expert's reset retreats."""
    reset_deviation: float = number(0.05, 0.0, 0.3)
    """Half-width of the uniform noise on the retreat, in x and in y."""


@dataclass(kw_only=True)
class VariationConfig:
    """What differs from episode to episode; nothing by default.

    Every episode draws its factors uniformly between the two that a field gives.
    """

    size: list[float] = factors(0.25, 3.0)
    """Lowest and highest factor on `object.size_ratio`."""
    mass: list[float] = factors(0.05, 20.0)
    """Factors on `object.mass`."""
    object_friction: list[float] = factors(0.0, 3.0)
    """Factors on `object.friction`."""
    table_friction: list[float] = factors(0.0, 3.0)
    """Factors on `table.friction`."""
    gripper_friction: list[float] = factors(0.0, 3.0)
    """Factors on `robot.gripper_friction`."""
    com_shift: float = number(0.0, 0.0, 0.1)
    """Distance by which the centre of mass moves in a random horizontal direction, m."""
    com_margin: float = number(0.005, 0.0, 0.05)
    """The shift ends where the centre of mass is this near to the support polygon's edge, m."""


@dataclass(kw_only=True)
class PredictorConfig:
    """The network of a policy that has learned."""

    weights: str = SHIPPED
    """Name of shipped weights, or path of a `.safetensors` file; "auto": the weights that ship
    under the policy's own name."""


@dataclass(kw_only=True)
class Scenario:
    """Everything that decides what an episode does."""

    seed: int = field(default=0, metadata={"range": (0, LARGEST_SEED)})
    """Root of every random draw."""
    policy: str = field(
        default="surface_no_com",
        metadata={"allowed": tuple(POLICIES), "form": (is_own_policy, OWN_POLICY)},
    )
    """Who drives the tool; see `keypush/policies.py`."""
    object: ObjectConfig = field(default_factory=ObjectConfig)
    variation: VariationConfig = field(default_factory=VariationConfig)
    table: TableConfig = field(default_factory=TableConfig)
    robot: RobotConfig = field(default_factory=RobotConfig)
    episode: EpisodeConfig = field(default_factory=EpisodeConfig)
    noise: NoiseConfig = field(default_factory=NoiseConfig)
    simulation: SimulationConfig = field(default_factory=SimulationConfig)
    control: ControlConfig = field(default_factory=ControlConfig)
    planner: PlannerConfig = field(default_factory=PlannerConfig)
    predictor: PredictorConfig = field(default_factory=PredictorConfig)

    def validate(self) -> None:
        """Checks every field's range, what varies, the box of start positions and the goal.

        Raises:
            UserError: names the field, what it holds and what is allowed.
        """
        check_values(self)
        _check_varied_fields(self)
        _check_start_box(self.robot)
        goal = self.episode.goal
        if goal is not None:
            _check_goal(goal, self.table)


def load_scenario(path: Path | str, defaults: Scenario | None = None) -> Scenario:
    """Reads a scenario; fields that the file leaves out keep their defaults.

    Raises:
        UserError: the file cannot be read, is no YAML, has an unknown field or a value
            of the wrong type or out of range.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"scenario {path}: cannot be read: {one_line(error)}") from error
    return parse_scenario(text, source=str(path), defaults=defaults)


def parse_scenario(
    text: str, *, source: str = "scenario", defaults: Scenario | None = None
) -> Scenario:
    """Parses a scenario's YAML text; see `load_scenario`."""
    try:
        data = parse_yaml(text, empty={})
        check_yaml(data, Scenario)
        scenario: Scenario = yaml_load_typed(
            schema=Scenario,
            data=text if data else "{}",
            defaults=defaults or Scenario(),
        )
        scenario.validate()
    except UserError as error:
        raise UserError(f"{source}: {error}") from error
    return scenario


def dump_scenario(scenario: Scenario) -> str:
    """Returns the whole scenario as YAML, every field written out."""
    text: str = yaml_dump_typed(scenario, schema=Scenario)
    # Drake leaves out what is null, but it must stay null over any defaults.
    for section, name in (("episode", "goal"), ("object", "mass")):
        if getattr(getattr(scenario, section), name) is None:
            text = text.replace(f"\n{section}:\n", f"\n{section}:\n  {name}: null\n", 1)
    return text


def _check_goal(goal: list[float], table: TableConfig) -> None:
    half = (table.reachable * table.length / 2, table.reachable * table.width / 2)
    ok = len(goal) == 2 and all(
        math.isfinite(g) and abs(g) <= h + 1e-9 for g, h in zip(goal, half, strict=True)
    )
    if not ok:
        raise UserError(
            f"episode.goal is {goal}; allowed: two numbers, |x| <= {half[0]:g} m and "
            f"|y| <= {half[1]:g} m (the reachable part of the table)"
        )


def _check_varied_fields(scenario: Scenario) -> None:
    """Checks that the fields stay in their ranges when they are multiplied by their factors."""
    for name, (section, varied) in VARIED_FIELDS.items():
        config = getattr(scenario, section)
        value = getattr(config, varied)
        if value is None:
            continue  # the object's own, which is known when it is read
        low, high = next(f for f in fields(config) if f.name == varied).metadata["range"]
        factors = getattr(scenario.variation, name)
        if not (low <= value * factors[0] and value * factors[1] <= high):
            raise UserError(
                f"variation.{name} is {factors} and {section}.{varied} is {value:g}; "
                f"allowed: products from {low:g} to {high:g}"
            )


def _check_start_box(robot: RobotConfig) -> None:
    for joint, (low, high) in enumerate(zip(robot.start_lower, robot.start_upper, strict=True), 1):
        if low > high:
            raise UserError(
                f"robot.start_lower is {low!r} and robot.start_upper is {high!r} at joint {joint}; "
                "allowed: start_lower at most start_upper at every joint"
            )
