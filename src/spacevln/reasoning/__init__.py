"""Spatial-CoT: planners and executors over the typed contexts of core."""
