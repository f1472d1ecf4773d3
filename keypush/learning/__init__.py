"""The learned keypoint: frames, network, data, training and prediction."""
