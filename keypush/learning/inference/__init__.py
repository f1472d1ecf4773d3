"""The networks in NumPy, for one scene at a time: what drives an episode needs no torch.

At batch size one PyTorch spends most of its time between operations; this is faster, needs no
thread settings and gives the same answer to rounding (tests and `keypush bench predictor` compare
them).
"""
