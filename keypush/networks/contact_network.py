"""ContactNetwork: which patches of a cloud touch the gripper; it pretrains the encoder."""

import torch
from torch import nn

from keypush.networks.config import WIDTH, EncoderConfig
from keypush.networks.patch_encoder import PatchTransformerEncoder


class ContactNetwork(nn.Module):
    """An encoder and a decoder that all patches share (CORN, section 3.2)."""

    def __init__(self, config: EncoderConfig) -> None:
        super().__init__()
        self.config = config
        self.encoder = PatchTransformerEncoder(config)
        self.decoder = nn.Sequential(
            nn.Linear(WIDTH, WIDTH), nn.LayerNorm(WIDTH), nn.GELU(),
            nn.Linear(WIDTH, WIDTH), nn.LayerNorm(WIDTH), nn.GELU(),
            nn.Linear(WIDTH, 1),
        )  # fmt: skip

    def forward(
        self,
        cloud: torch.Tensor,
        centres: torch.Tensor,
        members: torch.Tensor,
        hand: torch.Tensor,
    ) -> torch.Tensor:
        """Returns the logit of contact of every patch, (B, patches); arguments as the encoder's."""
        tokens = self.encoder(cloud, centres, members, hand)
        logits: torch.Tensor = self.decoder(tokens[:, 1:])[..., 0]
        return logits
