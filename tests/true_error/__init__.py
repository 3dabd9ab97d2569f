"""The error that a run has, against references that share no code with the core.

A scene is drawn from a family and a seed (`families`), pendcore runs it, and a reference
(`reference`) of more digits, which knows how far it can be trusted, says how far off the run was
(`judge`). `campaign` does so by the thousand.
"""
