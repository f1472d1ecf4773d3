"""Many rotation matrices at once."""

import torch
from torch.nn import functional


def random_rotations(count: int, generator: torch.Generator) -> torch.Tensor:
    """Draws rotations uniformly, (count, 3, 3)."""
    # Source: Marsaglia, "Choosing a Point from the Surface of a Sphere", 1972, on the 3-sphere.
    quaternion = functional.normalize(torch.randn(count, 4, generator=generator), dim=1)
    w, x, y, z = quaternion.unbind(dim=1)
    entries = [
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y),
    ]  # fmt: skip
    return torch.stack(entries, dim=1).view(count, 3, 3)


def turns_about_z(angle: torch.Tensor) -> torch.Tensor:
    """Rotations (B, 3, 3) about z by angles (B,), rad."""
    c, s = angle.cos(), angle.sin()
    zero, one = torch.zeros_like(c), torch.ones_like(c)
    return torch.stack([c, -s, zero, s, c, zero, zero, zero, one], dim=1).view(-1, 3, 3)


def tool_rotations(
    d_W: torch.Tensor, pitch: torch.Tensor, side: torch.Tensor, wrist_yaw: torch.Tensor
) -> torch.Tensor:
    """R_WE (B, 3, 3); the same as `planning.push_frame.tool_rotation`, for many.

    Args:
        d_W: horizontal unit vectors (B, 3).
        pitch: angles of Ez below the table plane (B,), rad.
        side: +1 or -1, (B,).
        wrist_yaw: angles of the finger row out of the push plane (B,), rad.
    """
    c, s = pitch.cos()[:, None], pitch.sin()[:, None]
    up = torch.tensor([0.0, 0.0, 1.0])
    left = torch.stack([-d_W[:, 1], d_W[:, 0], torch.zeros(len(d_W))], dim=1)
    z_axis = c * d_W - s * up
    in_plane = wrist_yaw.cos()[:, None] * (s * d_W + c * up)
    y_axis = side[:, None] * (in_plane + wrist_yaw.sin()[:, None] * left)
    return torch.stack([torch.linalg.cross(y_axis, z_axis), y_axis, z_axis], dim=2)
