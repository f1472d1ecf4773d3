"""The Panda: its model, and how it is added to a plant."""
