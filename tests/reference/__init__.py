"""What the compiled core is compared with: written in Python, independently of it, and plainly."""
