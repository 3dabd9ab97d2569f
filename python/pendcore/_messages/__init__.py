"""What the package says to its user: refused arguments, warnings, progress."""
