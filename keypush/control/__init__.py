"""Differential inverse kinematics as a function, without systems."""
