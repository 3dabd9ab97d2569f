"""What a scene simulates and what not, what that costs, and how fast it moves."""
