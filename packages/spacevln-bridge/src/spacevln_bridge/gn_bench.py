"""GN-Bench's simulator of Gaussian splats behind the same small class as Habitat-Sim.

Facts: the ``GN_Bench`` package as its public fork has it (KuroTaiga/GN-Bench-Tools at 46cf600): world coordinates are z-up,
heading is about z, the floor is z = 0, an agent's position is that of its camera, rotations are [x, y, z, w], actions numbers.
The field of view that its configuration calls horizontal is drawn as the vertical one. Nothing tells whether a step collided.
"""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

import numpy as np

from spacevln_bridge.messages import OpenSplats, SplatsOpened, Vector, View
from spacevln_bridge.simulator import Simulator, SimulatorError

ACTIONS = {"move_forward": 1, "turn_left": 2, "turn_right": 3}
COLOR, DEPTH = "rgb", "depth"
FAR_M = 1000.0
"""What the simulator puts where nothing is."""
COLLISION_M = 1e-3
"""A forward move that ends farther than this from where it should was cut short."""
SCENE_FILES = ("occupancy.json", "occupancy.png", "3dgs_compressed.ply")


class GNBenchSim(Simulator):
    """One simulator of the package, made when a scene is opened with other settings than before."""

    def __init__(self, package: Any) -> None:
        self._package = package
        self._sim: Optional[Any] = None
        self._asked: Optional[OpenSplats] = None
        self._seen: Dict[str, Any] = {}

    def open(self, asked: Any) -> SplatsOpened:
        """Load a scene's folder, unless it is loaded with the same settings."""
        if not isinstance(asked, OpenSplats):
            raise SimulatorError("usage", f"GN-Bench opens no {type(asked).__name__}.")
        if asked != self._asked:
            self._asked = None
            scene = Path(asked.scene)
            missing = [name for name in SCENE_FILES if not (scene / name).is_file()]
            if missing:
                raise SimulatorError("prerequisite", f"Scene {asked.scene!r} lacks {missing[0]}: give InteriorGS with --scenes.")
            self._load(asked)
            self._asked = asked
        return SplatsOpened(len(self._open_sim().gaussians.get_xyz))

    def place(self, position: Vector, rotation: Vector) -> View:
        """Put the body somewhere and look."""
        sim = self._open_sim()
        assert self._asked is not None  # noqa: S101 - _open_sim has looked
        x, y, z = _from_habitat(position)
        camera = np.array([x, y, z + self._asked.camera_height_m], np.float32)
        sim.set_agent_state(camera, np.array([*_from_habitat(rotation), rotation[3]], np.float64))
        self._seen = sim.reset()  # keeps the pose, and forgets the walk that it would draw
        return self._view(collided=False)

    def act(self, action: str) -> View:
        """One primitive; a move that did not end where it should have has collided."""
        sim = self._open_sim()
        assert self._asked is not None  # noqa: S101 - _open_sim has looked
        before, yaw = self._state()
        self._seen = sim.step(ACTIONS[action])
        after, _ = self._state()
        step_m = self._asked.step_m if action == "move_forward" else 0.0
        wanted = before + step_m * np.array([math.cos(yaw), math.sin(yaw), 0.0])
        return self._view(collided=bool(np.linalg.norm(after - wanted) > COLLISION_M))

    def draw(self, rgba: Any, depth: Any, labels: Any) -> None:
        """Copy what was seen last into arrays; there are no labels."""
        del labels
        np.copyto(rgba[..., :3], np.asarray(self._seen[COLOR])[..., :3])
        np.copyto(depth, np.asarray(self._seen[DEPTH]).reshape(depth.shape))
        depth[depth >= FAR_M] = 0

    def close(self) -> None:
        """Free everything."""
        if self._sim is not None:
            self._sim.close()
            self._sim = None

    def _open_sim(self) -> Any:
        if self._sim is None:
            raise SimulatorError("usage", "No scene is open: send OpenSplats first.")
        return self._sim

    def _load(self, asked: OpenSplats) -> None:
        if asked.gpu_device > 0:  # the simulator draws on the current one
            import torch

            torch.cuda.set_device(asked.gpu_device)
        configuration = self._configuration(asked)
        self.close()
        with tempfile.TemporaryDirectory() as folder:
            reference = Path(folder) / "reference.json"
            reference.write_text(json.dumps(reference_of(Path(asked.scene))), encoding="utf-8")
            configuration.defrost()
            configuration.SCENE, configuration.REF_JSON = asked.scene, str(reference)
            configuration.freeze()
            self._sim = self._package.sims.make_sim("Sim-v0", config=configuration)
            self._sim.reconfigure(configuration)
            self._sim.seed(asked.seed)

    def _configuration(self, asked: OpenSplats) -> Any:
        configuration = self._package.get_config().SIMULATOR.clone()
        configuration.defrost()
        configuration.FORWARD_STEP_SIZE, configuration.TURN_ANGLE = asked.step_m, asked.turn_deg
        configuration.COLLIDABLE = True
        if hasattr(configuration, "DOOR_TELEPORT"):  # forks jump through doors
            configuration.DOOR_TELEPORT.ENABLED = False
        configuration.AGENT_0.SENSORS = ["RGB_SENSOR", "DEPTH_SENSOR"]
        half = math.radians(asked.hfov_deg) / 2
        vertical_deg = 2 * math.degrees(math.atan(math.tan(half) * asked.height_px / asked.width_px))
        for sensor in (configuration.RGB_SENSOR, configuration.DEPTH_SENSOR):
            sensor.WIDTH, sensor.HEIGHT, sensor.HFOV = asked.width_px, asked.height_px, vertical_deg
        depth = configuration.DEPTH_SENSOR
        depth.MIN_DEPTH, depth.MAX_DEPTH, depth.NORMALIZE_DEPTH = 0.0, FAR_M, False
        configuration.freeze()
        return configuration

    def _state(self) -> Tuple[Any, float]:
        """Position of the camera (3,), and heading."""
        state = self._open_sim().get_agent_state()
        x, y, z, w = (float(each) for each in np.asarray(state.rotation))
        return np.asarray(state.position, np.float64), math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))

    def _view(self, collided: bool) -> View:
        assert self._asked is not None  # noqa: S101 - the caller has an open scene
        camera, yaw = self._state()
        rotation = (0.0, math.sin(yaw / 2), 0.0, math.cos(yaw / 2))
        return View(
            position=_to_habitat(camera - [0.0, 0.0, self._asked.camera_height_m]),
            rotation=rotation,
            camera_position=_to_habitat(camera),
            camera_rotation=rotation,
            collided=collided,
            image=b"",
        )


def reference_of(scene: Path) -> Dict[str, Any]:
    """What the simulator wants to know of an episode, made from the scene alone.

    It fits where its splats lie to pairs of world points and pixels. Corners of the occupancy map serve: an episode's path,
    which is ground truth, need not come here; and one along a single axis could not be fitted.
    """
    place = json.loads((scene / "occupancy.json").read_text(encoding="utf-8"))
    width, height = _png_size(scene / "occupancy.png")
    (left, bottom), (right, top) = place["lower"][:2], place["upper"][:2]
    pixels = [(0, 0), (width - 1, 0), (width - 1, height - 1), (0, height - 1)]
    along = [left + (column + 0.5) * (right - left) / width for column, _ in pixels]
    across = [top - (row + 0.5) * (top - bottom) / height for _, row in pixels]
    world = [{"x": -x, "y": -y} for x, y in zip(along, across)]
    return {
        "start": {"world": {"x": 0.0, "y": 0.0}},
        "start_facing": {"world": {"heading_degrees": 0.0}},
        "path": {"raster_world": world, "raster_pixel": [list(pixel) for pixel in pixels]},
    }


def _png_size(path: Path) -> Tuple[int, int]:
    with path.open("rb") as file:
        head = file.read(24)
    if head[:8] != b"\x89PNG\r\n\x1a\n":
        raise SimulatorError("prerequisite", f"{str(path)!r} is no PNG picture: get the scene again.")
    return int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big")


def _to_habitat(point: Any) -> Vector:
    """(x, y, z), z up, becomes (-y, z, -x)."""
    x, y, z = (float(each) for each in point)
    return (-y, z, -x)


def _from_habitat(vector: Any) -> Vector:
    """(x, y, z) of Habitat becomes (-z, -x, y)."""
    x, y, z = (float(each) for each in vector[:3])
    return (-z, -x, y)
