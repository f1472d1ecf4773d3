"""Frames G of many scenes at once, in PyTorch, for training; see `inference.goal_frame`."""

from dataclasses import dataclass

import torch

from keypush.learning.inference.goal_frame import LENGTH


@dataclass(frozen=True)
class GoalFrames:
    """Frames G of B scenes; the same maths as `GoalFrame`.

    Attributes:
        origin: p_WGo_W, shape (B, 3), z = 0.
        R_WG: shape (B, 3, 3).
    """

    origin: torch.Tensor
    R_WG: torch.Tensor

    @staticmethod
    def of(centres: torch.Tensor, goals_W: torch.Tensor) -> "GoalFrames":
        """Makes the frames from centres (B, >= 2) and goals (B, >= 2)."""
        offset = goals_W[:, :2] - centres[:, :2]
        distance = offset.norm(dim=1, keepdim=True)
        fallback = torch.tensor([1.0, 0.0], dtype=offset.dtype)
        d = torch.where(distance > 0, offset / distance.clamp_min(1e-12), fallback)
        R_WG = torch.zeros(len(d), 3, 3, dtype=offset.dtype)
        R_WG[:, :2, 0] = d
        R_WG[:, 0, 1], R_WG[:, 1, 1] = -d[:, 1], d[:, 0]
        R_WG[:, 2, 2] = 1.0
        origin = torch.cat([centres[:, :2], torch.zeros_like(distance)], dim=1)
        return GoalFrames(origin, R_WG)

    def to_goal(self, p_W: torch.Tensor) -> torch.Tensor:
        """Expresses points (B, N, 3) of W in G, in units of `LENGTH`."""
        return torch.bmm(p_W - self.origin[:, None], self.R_WG) / LENGTH

    def hands_to_goal(self, hands_W: torch.Tensor) -> torch.Tensor:
        """Expresses hand states (B, 9) in G; see `GoalFrame.hand_to_goal`."""
        position = self.to_goal(hands_W[:, None, :3])[:, 0]
        axes = torch.bmm(hands_W[:, 3:].reshape(-1, 2, 3), self.R_WG)
        return torch.cat([position, axes.reshape(-1, 6)], dim=1)
