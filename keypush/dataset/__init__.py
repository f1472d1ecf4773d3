"""The data set: a folder in the format LeRobotDataset v3.0, written, read and checked."""
