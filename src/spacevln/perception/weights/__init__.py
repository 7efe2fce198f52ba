"""Published weights: what there is, where it lies, fetching it on request, and whether a file is what it should be."""

from spacevln.perception.weights.catalogue import PublishedFile, PublishedModel, catalogue, published_model
from spacevln.perception.weights.download import Progress, download
from spacevln.perception.weights.store import FileState, ModelState, WeightStore

__all__ = [
    "FileState",
    "ModelState",
    "Progress",
    "PublishedFile",
    "PublishedModel",
    "WeightStore",
    "catalogue",
    "download",
    "published_model",
]
