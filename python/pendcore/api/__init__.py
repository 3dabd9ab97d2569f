"""What a user holds: scenes and solutions whose methods lead to all the rest."""
