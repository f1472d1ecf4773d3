"""The thesis' networks trained on an expert's episodes: keypoint and behaviour cloning."""
