"""The thesis' ablation: sizes of encoder and head, each with and without the centre of mass."""
