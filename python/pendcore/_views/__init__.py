"""What can be made of a solution: figures, tables, summaries, other libraries' objects."""
