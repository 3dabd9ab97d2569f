"""How far to trust a run: its error over time, Lyapunov exponents, and what a digit is worth."""
