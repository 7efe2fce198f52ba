"""A simulator in a Python of its own: its worker, what is asked of it, and the environment made from its answers."""
