"""Procedural furnished houses: seeded, deterministic, rendered by MuJoCo (DESIGN 5.1)."""
