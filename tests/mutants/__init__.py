"""Mutants: the program with one small mistake each, and which of them the tests notice."""
