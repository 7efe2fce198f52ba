"""Habitat-Sim, in its own Python behind a bridge, and the only place that knows its frames."""
