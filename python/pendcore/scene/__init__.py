"""What is simulated, as plain data: links, gravity, effects."""
