"""keypush: pushing unseen objects through one predicted contact keypoint, in Drake."""

from importlib.metadata import version

__version__ = version("keypush")
