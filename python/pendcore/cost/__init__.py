"""What accuracy costs on a scene: methods and tolerances swept, errors and times measured."""
