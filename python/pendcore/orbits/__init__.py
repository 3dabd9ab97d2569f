"""Equilibria, periodic orbits, their families, their manifolds and the motions between them."""
