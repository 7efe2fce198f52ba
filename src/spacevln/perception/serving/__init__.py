"""One detector for many processes of a machine: a server that batches what comes in, and clients that start it at need."""

from spacevln.perception.serving.client import ServerCounts, SharedDetector

__all__ = ["ServerCounts", "SharedDetector"]
