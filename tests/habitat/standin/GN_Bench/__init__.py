"""A stand-in for GN-Bench's simulator package, with the recorded house in place of splats.

Its behaviour is that of the public fork KuroTaiga/GN-Bench-Tools at 46cf600, read and not run; nothing of it is copied. What differs:
pictures are drawn from the house's triangles, where they lie by occupancy.json; doors are not jumped through (the house names none).
"""

from GN_Bench import sims
from GN_Bench._config import get_config

__all__ = ["get_config", "sims"]
