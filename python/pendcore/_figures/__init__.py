"""The figures of a run, drawn with matplotlib: curves over time, curves in the plane, poses."""
