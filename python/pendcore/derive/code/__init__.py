"""A derivation as code: MATLAB and Octave, Python, C++."""
