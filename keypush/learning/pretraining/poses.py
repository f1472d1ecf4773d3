"""Where gripper and object are in many scenes."""

from dataclasses import dataclass

import torch


@dataclass(frozen=True)
class Poses:
    """Poses of B scenes in W, lengths in m.

    Attributes:
        R_WO: (B, 3, 3).
        p_WO: (B, 3).
        R_WE: (B, 3, 3).
        p_WE: (B, 3).
    """

    R_WO: torch.Tensor
    p_WO: torch.Tensor
    R_WE: torch.Tensor
    p_WE: torch.Tensor

    def to_world(self, p_O: torch.Tensor) -> torch.Tensor:
        """Expresses points (B, N, 3) of O in W."""
        return torch.bmm(p_O, self.R_WO.transpose(1, 2)) + self.p_WO[:, None]

    def to_hand(self, p_O: torch.Tensor) -> torch.Tensor:
        """Expresses points (B, N, 3) of O in E."""
        return torch.bmm(self.to_world(p_O) - self.p_WE[:, None], self.R_WE)

    def hand(self) -> torch.Tensor:
        """Hand states (B, 9): position in m and the first two axes; see `learning.hand`."""
        axes = self.R_WE[:, :, :2].transpose(1, 2).reshape(-1, 6)
        return torch.cat([self.p_WE, axes], dim=1)


def join(first: Poses, second: Poses) -> Poses:
    """Puts scenes behind scenes."""
    return Poses(*(
        torch.cat([getattr(first, name), getattr(second, name)]) for name in vars(first)
    ))  # fmt: skip
