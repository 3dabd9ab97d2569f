"""What is simulated: links, gravity, effects."""
