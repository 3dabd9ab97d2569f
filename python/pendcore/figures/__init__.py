"""What is drawn of a run with matplotlib: curves over time, in the plane, and poses."""
