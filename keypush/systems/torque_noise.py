"""TorqueNoise: Gaussian joint torques, redrawn each policy step."""

from pydrake.systems.framework import Context, DiscreteValues, EventStatus, LeafSystem

from keypush.systems.episode_seed import declare_episode_seed, episode_generator, policy_step


class TorqueNoise(LeafSystem):
    """Draws joint torques N(0, deviation) and holds them for one policy step.

    @system
    name: TorqueNoise
    output_ports:
    - torque
    @endsystem

    ``torque``: vector of n, Nm, one per joint in actuator order; updated with the policy
    period. It is zero until the first update, at time 0.

    Draws depend on seed, episode and policy step alone (parameter [seed, episode]).
    """

    def __init__(self, joints: int, deviation: float, policy_period: float) -> None:
        """Args: number of joints; standard deviation in Nm; period in s."""
        super().__init__()
        self.set_name("torque_noise")
        self._joints = joints
        self._deviation = deviation
        self._period = policy_period
        declare_episode_seed(self)
        state = self.DeclareDiscreteState(joints)
        self.DeclareStateOutputPort("torque", state)
        self.DeclarePeriodicDiscreteUpdateEvent(policy_period, 0.0, self._draw)

    def _draw(self, context: Context, state: DiscreteValues) -> EventStatus:
        generator = episode_generator(context, "torque", policy_step(context, self._period))
        state.set_value(0, generator.normal(scale=self._deviation, size=self._joints))
        return EventStatus.Succeeded()
