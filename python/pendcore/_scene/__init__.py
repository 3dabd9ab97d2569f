"""Scenes have links, gravity and effects: all that is simulated stands here."""
