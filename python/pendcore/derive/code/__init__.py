"""A derivation as code, printed by SymPy into short templates: MATLAB and Octave, Python, C++."""
