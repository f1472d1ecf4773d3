"""The success rates that the thesis gives, in percent (tables 5.5 to 5.8, 50 episodes per object).

Source: "Learning Robot Motion Policies for Pushing Objects that Generalize", chapter 5.
"""

from collections.abc import Mapping

POLICIES = ("keypoint", "keypoint_no_com", "behavior_cloning")
"""The thesis' columns: ours with COM, ours without COM, BC."""
COM_SHIFT = 0.015
"""Shift of the centre of mass in table 5.8, m."""

Rates = tuple[float, float, float]

SIZE_TABLES: Mapping[str, tuple[str, Mapping[float, Rates]]] = {
    "train": (
        "5.5",
        {
            1.0: (87.1, 50.3, 40.5),
            0.875: (86.4, 44.7, 35.5),
            0.75: (80.9, 42.7, 32.9),
            1.125: (87.0, 48.9, 37.8),
            1.25: (83.5, 49.5, 38.1),
        },
    ),
    "id": (
        "5.6",
        {
            1.0: (82.7, 48.9, 36.5),
            0.875: (77.4, 43.7, 32.5),
            0.75: (74.8, 41.1, 30.3),
            1.125: (85.6, 55.5, 38.8),
            1.25: (90.3, 57.6, 42.1),
        },
    ),
    "ood": (
        "5.7",
        {
            1.0: (59.3, 34.4, 28.2),
            0.875: (62.0, 42.1, 31.0),
            0.75: (56.6, 34.5, 28.7),
            1.125: (61.3, 37.3, 34.5),
            1.25: (59.9, 41.9, 32.9),
        },
    ),
}
"""Number of the table and rates by size ratio, for each set of objects."""

SHIFTED: Mapping[str, tuple[Rates, Rates]] = {
    "block": ((88.9, 63.0, 54.5), (53.0, 25.6, 20.4)),
    "bottle": ((86.7, 60.0, 46.3), (28.8, 13.5, 19.4)),
    "elephant": ((91.7, 50.0, 41.0), (30.3, 14.9, 17.2)),
    "telephone": ((77.8, 33.3, 22.9), (42.4, 19.1, 15.1)),
    "mug": ((92.6, 40.7, 25.6), (28.8, 20.2, 13.8)),
}
"""Table 5.8: rates with the normal and with the shifted centre of mass, by object."""

SIZES = tuple(SIZE_TABLES["train"][1])
"""In the order of the thesis' tables."""


def size_rate(group: str, size_ratio: float, policy: str) -> float | None:
    """Returns the rate of tables 5.5 to 5.7 in percent; None for what the thesis lacks."""
    rates = SIZE_TABLES[group][1]
    return _of(policy, rates[size_ratio])


def shifted_rate(name: str, policy: str, *, shifted: bool) -> float | None:
    """Returns the rate of table 5.8 in percent; None for a policy that the thesis lacks."""
    return _of(policy, SHIFTED[name][shifted])


def _of(policy: str, rates: Rates) -> float | None:
    return rates[POLICIES.index(policy)] if policy in POLICIES else None
