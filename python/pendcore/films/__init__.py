"""Runs that move: frames, matplotlib's animation, video files."""
