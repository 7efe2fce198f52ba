"""EfficientSAM's two files with the published inputs and outputs and almost nothing inside."""

from __future__ import annotations

from pathlib import Path

from onnx import TensorProto, helper, numpy_helper, save_model


def efficient_sam(folder: Path) -> Path:
    """The encoder hands the image on; the decoder's three masks are colour channels minus a half, the second the best."""
    import numpy as np

    images = helper.make_tensor_value_info("batched_images", TensorProto.FLOAT, [1, 3, "h", "w"])
    embedding = helper.make_tensor_value_info("image_embeddings", TensorProto.FLOAT, [1, 3, "h", "w"])
    _save(
        [helper.make_node("Identity", ["batched_images"], ["image_embeddings"])],
        [images],
        [embedding],
        folder / "efficient_sam_vitt_encoder.onnx",
    )
    points = helper.make_tensor_value_info("batched_point_coords", TensorProto.FLOAT, [1, 1, "n", 2])
    labels = helper.make_tensor_value_info("batched_point_labels", TensorProto.FLOAT, [1, 1, "n"])
    size = helper.make_tensor_value_info("orig_im_size", TensorProto.INT64, [2])
    masks = helper.make_tensor_value_info("output_masks", TensorProto.FLOAT, [1, 1, 3, "h", "w"])
    quality = helper.make_tensor_value_info("iou_predictions", TensorProto.FLOAT, [1, 1, 3])
    constants = [
        numpy_helper.from_array(np.array(0.5, np.float32), "half"),
        numpy_helper.from_array(np.array([1], np.int64), "axis"),
        numpy_helper.from_array(np.array([[[0.2, 0.9, 0.3]]], np.float32), "scores"),
    ]
    nodes = [
        helper.make_node("Sub", ["image_embeddings", "half"], ["centred"]),
        helper.make_node("Unsqueeze", ["centred", "axis"], ["output_masks"]),
        helper.make_node("Identity", ["scores"], ["iou_predictions"]),
        helper.make_node("Identity", ["batched_point_coords"], ["unused_points"]),
        helper.make_node("Identity", ["batched_point_labels"], ["unused_labels"]),
        helper.make_node("Identity", ["orig_im_size"], ["unused_size"]),
    ]
    _save(nodes, [embedding, points, labels, size], [masks, quality], folder / "efficient_sam_vitt_decoder.onnx", constants)
    return folder


def _save(
    nodes: list[object], inputs: list[object], outputs: list[object], path: Path, constants: list[object] | None = None
) -> None:
    graph = helper.make_graph(nodes, "tiny", inputs, outputs, constants or [])
    save_model(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8), path)
