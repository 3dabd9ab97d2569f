"""The functions that users call: `simulate`, `ensemble`, `load`, `read_case`."""
