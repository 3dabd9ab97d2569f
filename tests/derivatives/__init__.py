"""Random runs whose derivatives are held against a reference."""
