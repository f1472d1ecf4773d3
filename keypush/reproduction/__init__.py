"""The thesis' tables of success rates, run anew."""
