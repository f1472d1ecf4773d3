"""The neural networks in plain PyTorch: shapes in, shapes out; no data, no files."""
