"""Episodes: how they start, how they run, how many run side by side."""
