"""ContactSensor: the measured contact of tool and object."""

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.geometry import GeometryId
from pydrake.multibody.plant import ContactResults
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BasicVector, Context, LeafSystem

from keypush.eval_ports import eval_abstract


class ContactSensor(LeafSystem):
    """Measures where and how hard the robot touches the object.

    @system
    name: ContactSensor
    input_ports:
    - contact_results
    output_ports:
    - contact
    @endsystem

    ``contact_results``: abstract `ContactResults`, the plant's port of that name.

    ``contact``: vector of 6: the force-weighted centroid p_WC of all contacts between robot
    and object in W in m (NaN where they do not touch), then the force on the object f_O_W
    in N (zero where they do not touch).
    """

    def __init__(
        self,
        robot_geometries: frozenset[GeometryId],
        object_geometries: frozenset[GeometryId],
        robot_bodies: frozenset[BodyIndex],
        object_body: BodyIndex,
    ) -> None:
        """Args: collision geometries and bodies of the robot and of the object."""
        super().__init__()
        self.set_name("contact_sensor")
        # Numbers, because pydrake's ids keep the plant alive that they come from, and with it,
        # in a cycle through this system, the whole diagram for ever.
        self._robot = {g.get_value() for g in robot_geometries}
        self._object = {g.get_value() for g in object_geometries}
        self._robot_bodies = {int(b) for b in robot_bodies}
        self._object_body = int(object_body)
        self._results = self.DeclareAbstractInputPort("contact_results", Value[ContactResults]())
        self.DeclareVectorOutputPort(
            "contact", 6, self._calc_contact, prerequisites_of_calc={self._results.ticket()}
        )

    def _calc_contact(self, context: Context, output: BasicVector) -> None:
        results: ContactResults = eval_abstract(self._results, context)
        pairs = [*self._hydroelastic(results), *self._points(results)]
        output.SetFromVector(_combine(pairs))

    def _hydroelastic(
        self, results: ContactResults
    ) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        pairs = []
        for i in range(results.num_hydroelastic_contacts()):
            info = results.hydroelastic_contact_info(i)
            surface = info.contact_surface()
            m, n = surface.id_M().get_value(), surface.id_N().get_value()
            if m in self._object and n in self._robot:
                sign = 1.0
            elif n in self._object and m in self._robot:
                sign = -1.0
            else:
                continue
            # The spatial force is the one on body A, which owns geometry M.
            pairs.append((surface.centroid(), sign * info.F_Ac_W().translational()))
        return pairs

    def _points(
        self, results: ContactResults
    ) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
        pairs = []
        for i in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(i)
            a, b = int(info.bodyA_index()), int(info.bodyB_index())
            if b == self._object_body and a in self._robot_bodies:
                sign = 1.0
            elif a == self._object_body and b in self._robot_bodies:
                sign = -1.0
            else:
                continue
            # The force is the one on body B.
            pairs.append((info.contact_point(), sign * info.contact_force()))
        return pairs


def _combine(
    pairs: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> NDArray[np.float64]:
    weights = np.array([np.linalg.norm(force) for _, force in pairs])
    if weights.sum() < 1e-9:
        return np.concatenate([np.full(3, np.nan), np.zeros(3)])
    points = np.array([point for point, _ in pairs])
    total = np.sum([force for _, force in pairs], axis=0)
    return np.concatenate([weights @ points / weights.sum(), total])
