"""One run: what is asked for, the call of the core, and its solution."""
