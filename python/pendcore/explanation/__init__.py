"""What scenes and runs say of themselves: `scene.explain()` and `print(sol)`."""
