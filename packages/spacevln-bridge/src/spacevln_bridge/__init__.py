"""Habitat-Sim in its own interpreter: messages, the channel that carries them, and the worker that serves them."""

__version__ = "0.1.0"
