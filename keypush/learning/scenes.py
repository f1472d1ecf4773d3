"""Rows as scenes in frame C, and their augmentation there.

Frame C is the goal frame with its origin at the COM, in m: Co on the table plane below the COM, Cx
towards the goal. The expert pushes along Cx, so whatever maps the plane y = 0 of C to itself and
keeps its heights near the table takes a scene and its label to another valid scene and label.
"""

import dataclasses
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from keypush.dataset.poses import hand_states, rotations
from keypush.learning.clouds import CloudBank
from keypush.learning.goal_frame import GoalFrames
from keypush.learning.inference.goal_frame import LENGTH
from keypush.learning.rows import Rows
from keypush.networks.surface_keypoint_network import NetworkInput

STRETCH = 0.25
"""Half-width of the logarithm of a stretch along x, y and z."""
SHEAR = 0.3
"""Half-width of dx/dy."""
BEND = 8.0
"""Half-width of the coefficient of x += b y^2, 1/m: 2 cm at 5 cm from the middle."""
TAPER = 5.0
"""Half-width of the relative growth in x and y per metre of height."""


@dataclass(frozen=True)
class SceneTable:
    """The poses and labels of n scenes in C, without their clouds.

    Attributes:
        object_index: entry of the objects that the cloud bank was drawn for, (n,).
        R_CO: (n, 3, 3).
        p_CO: (n, 3).
        goal: goal in C, (n, 3); y = z = 0.
        com: p_COcm, (n, 3); x = y = 0.
        hand: hand state in C, (n, 9).
        label: p_CK, (n, 3).
    """

    object_index: torch.Tensor
    R_CO: torch.Tensor
    p_CO: torch.Tensor
    goal: torch.Tensor
    com: torch.Tensor
    hand: torch.Tensor
    label: torch.Tensor

    def __len__(self) -> int:
        return len(self.object_index)

    def take(self, index: torch.Tensor) -> "SceneTable":
        """Returns some of the scenes."""
        parts = {f.name: getattr(self, f.name)[index] for f in dataclasses.fields(self)}
        return SceneTable(**parts)


@dataclass(frozen=True)
class SceneBatch:
    """B scenes in C with clouds (B, N, 3); other attributes as in `SceneTable`."""

    cloud: torch.Tensor
    centres: torch.Tensor
    members: torch.Tensor
    goal: torch.Tensor
    com: torch.Tensor
    hand: torch.Tensor
    label: torch.Tensor


def scene_table(rows: Rows, label: NDArray[np.float64]) -> SceneTable:
    """Expresses rows and their labels p_WK (n, 3) in C."""
    frames = GoalFrames.of(torch.from_numpy(rows.com), torch.from_numpy(rows.goal))
    R_CW = frames.R_WG.transpose(1, 2)

    def in_frame(p_W: NDArray[np.float64]) -> torch.Tensor:
        return (frames.to_goal(torch.from_numpy(p_W)[:, None])[:, 0] * LENGTH).float()

    hand = frames.hands_to_goal(torch.from_numpy(hand_states(rows.tool_pose))).float()
    hand[:, :3] *= LENGTH
    return SceneTable(
        object_index=torch.from_numpy(rows.object_index),
        R_CO=(R_CW @ torch.from_numpy(rotations(rows.object_pose))).float(),
        p_CO=in_frame(rows.object_pose[:, 4:]),
        goal=in_frame(np.column_stack([rows.goal, np.zeros(len(rows))])),
        com=in_frame(rows.com),
        hand=hand,
        label=in_frame(label),
    )


def with_clouds(table: SceneTable, bank: CloudBank, generator: torch.Generator) -> SceneBatch:
    """Gives every scene a random cloud of its object."""
    entry = bank.choose(table.object_index, generator)
    cloud = torch.bmm(bank.cloud[entry], table.R_CO.transpose(1, 2)) + table.p_CO[:, None]
    return SceneBatch(
        cloud=cloud,
        centres=bank.centres[entry],
        members=bank.members[entry],
        goal=table.goal,
        com=table.com,
        hand=table.hand,
        label=table.label,
    )


def augment(batch: SceneBatch, generator: torch.Generator) -> SceneBatch:
    """Mirrors, stretches, shears, bends and tapers every scene about its line of push."""
    size = len(batch.cloud)

    def draw(half_width: float) -> torch.Tensor:
        return half_width * (2 * torch.rand(size, 1, generator=generator) - 1)

    side = torch.where(draw(1.0) < 0, -1.0, 1.0)
    stretch = [draw(STRETCH).exp() for _ in range(3)]
    shear, bend, taper = draw(SHEAR), draw(BEND), draw(TAPER)
    pivot = batch.label[:, 2:]

    def warp(p: torch.Tensor) -> torch.Tensor:
        above = p[..., 2] - pivot
        growth = (1 + taper * above).clamp(0.3, 2.0)
        y = side * stretch[1] * growth * p[..., 1]
        x = stretch[0] * growth * p[..., 0] + shear * y + bend * y.square()
        # Heights below the label stay, so the label's own height does.
        z = p[..., 2] + (stretch[2] - 1) * above.clamp_min(0)
        return torch.stack([x, y, z], dim=-1)

    cloud, label = warp(batch.cloud), warp(batch.label[:, None])[:, 0]
    com = warp(batch.com[:, None])[:, 0]
    # A bend moves the COM of the object, though not the point of the object that was its COM.
    com[:, :1] += bend * cloud[:, :, 1].square().mean(dim=1, keepdim=True)
    return dataclasses.replace(
        batch, cloud=cloud, com=com, label=label, hand=_augmented_hand(batch, side, label)
    )


def _augmented_hand(batch: SceneBatch, side: torch.Tensor, label: torch.Tensor) -> torch.Tensor:
    """Mirrors hands where `side` (B, 1) is -1, and moves them along with the label."""
    mirror = torch.cat([torch.ones_like(side), side, torch.ones_like(side)], dim=1)
    hand = batch.hand.clone()
    hand[:, :3] = label + mirror * (batch.hand[:, :3] - batch.label)
    # The mirrored tool is the tool itself, as its own y = 0 is a plane of symmetry.
    hand[:, [4, 6, 8]] *= side
    return hand


def to_network(batch: SceneBatch, *, use_com: bool) -> tuple[NetworkInput, torch.Tensor]:
    """Expresses scenes in the goal frame G.

    Returns:
        The network's input, and labels p_GK (B, 3).
    """
    frames = GoalFrames.of(batch.com if use_com else batch.cloud.mean(dim=1), batch.goal)
    goal, com, label = frames.to_goal(
        torch.stack([batch.goal, batch.com, batch.label], dim=1)
    ).unbind(dim=1)
    scene = NetworkInput(
        cloud=frames.to_goal(batch.cloud),
        centres=batch.centres,
        members=batch.members,
        goal=goal[:, :2],
        com=com,
        hand=frames.hands_to_goal(batch.hand),
    )
    return scene, label
