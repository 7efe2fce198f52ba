"""Makes pictures and expectations for detectors with their published weights: two views of houses, and what is there.

``python tests/perception/make_renders.py`` writes them to ``tests/perception/renders``, which is kept (software OpenGL).
"""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np

from spacevln.core import Camera, Pose
from spacevln.environments.houses.environment import load_place
from spacevln.environments.houses.labels import house_labels
from spacevln.environments.houses.rendering import make_renderer, renderer_info

FOLDER = Path(__file__).parent / "renders"
CAMERA = Camera(640, 480, 79.0, 0.88)
VIEWS = {
    "living_room": (2, Pose(9.284, 8.552, 0.0, 0.089), ("sofa", "tv", "fireplace", "coffee table")),
    "bedroom": (3, Pose(5.743, 9.608, 0.0, -0.460), ("bed", "rocking chair", "rug", "suitcase")),
}


def main() -> None:
    """Write pictures, masks and boxes."""
    FOLDER.mkdir(exist_ok=True)
    expected: dict[str, dict[str, list[int]]] = {}
    for name, (seed, pose, categories) in VIEWS.items():
        place = load_place(f"house-{seed:06d}")
        renderer = make_renderer(renderer_info("gl"), place.drawable, CAMERA.width_px, CAMERA.height_px)
        T_scene_camera = pose.T_world_body
        T_scene_camera[2, 3] += CAMERA.height_m
        frame = renderer.render(T_scene_camera, CAMERA)
        labels = house_labels(place.drawable.house)
        cv2.imwrite(str(FOLDER / f"{name}.jpg"), frame.rgb[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, 92])
        masks = np.zeros(frame.instance_ids.shape, np.uint8)
        expected[name] = {}
        for index, category in enumerate(categories, start=1):
            instances = [number for number, label in labels.items() if label.category == category]
            counts = {number: int((frame.instance_ids == number).sum()) for number in instances}
            number = max(counts, key=lambda each: counts[each])
            rows, columns = np.nonzero(frame.instance_ids == number)
            masks[rows, columns] = index
            box = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
            expected[name][category] = [int(edge) for edge in box]
        cv2.imwrite(str(FOLDER / f"{name}.png"), masks)
    (FOLDER / "expected.json").write_text(json.dumps(expected, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
