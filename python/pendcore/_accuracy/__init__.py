"""What accuracy costs: errors against independent runs, and the method and tolerance for one."""
