"""Contact pretraining: drawn scenes of a gripper near objects, and the network that learns them."""
