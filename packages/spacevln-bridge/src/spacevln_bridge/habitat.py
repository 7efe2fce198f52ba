"""Habitat-Sim 0.1.7, 0.2.x and 0.3.x behind one small class; what differs between versions is found by trying, here only.

Facts: habitat-sim's Python API at the tags v0.1.7 to v0.3.4, and records of 0.2.2 and 0.3.4.
"""

from __future__ import annotations

import hashlib
import math
import os
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

import numpy as np

from spacevln_bridge.messages import Open, Opened, Vector, View
from spacevln_bridge.simulator import MeasuringSimulator, SimulatorError

COLOR, DEPTH, SEMANTIC = "rgb", "depth", "semantic"


class HabitatSim(MeasuringSimulator):
    """One Habitat-Sim, reused over scenes; it makes at most one GL context in this process."""

    def __init__(self, habitat: Any) -> None:
        self._habitat = habitat
        self._sim: Optional[Any] = None
        self._asked: Optional[Open] = None
        self._opened: Optional[Opened] = None
        self._seen: Dict[str, Any] = {}

    def open(self, asked: Any) -> Opened:
        """Load a scene, unless it is loaded with the same settings, and give it the navigation mesh that was asked for.

        Raises:
            SimulatorError: the scene is missing or has no floor to walk on.
        """
        if not isinstance(asked, Open):
            raise SimulatorError("usage", f"Habitat-Sim opens no {type(asked).__name__}.")
        if asked == self._asked and self._opened is not None:
            return self._opened
        if not Path(asked.scene).exists():
            raise SimulatorError("prerequisite", f"Scene {asked.scene!r} is missing: give the folder of scenes with --scenes.")
        self._asked = self._opened = None
        configuration = self._configuration(asked)
        if self._sim is None:
            self._sim = self._habitat.Simulator(configuration)
        else:
            self._sim.reconfigure(configuration)
        self._sim.seed(asked.seed)
        self._sim.pathfinder.seed(asked.seed)
        mesh = self._navigation_mesh(asked)
        self._asked, self._opened = asked, Opened(categories=self._categories(asked), **mesh)
        return self._opened

    def place(self, position: Vector, rotation: Vector) -> View:
        """Put the body somewhere and look."""
        state = self._habitat.AgentState()
        state.position = np.asarray(position, np.float32)
        state.rotation = self._habitat.utils.common.quat_from_coeffs(np.asarray(rotation, np.float32))
        sim = self._open_sim()
        sim.get_agent(0).set_state(state)
        self._seen = sim.get_sensor_observations()
        return self._view(collided=False)

    def act(self, action: str) -> View:
        """One primitive."""
        self._seen = self._open_sim().step(action)
        return self._view(collided=bool(self._seen["collided"]))

    def draw(self, rgba: Any, depth: Any, labels: Any) -> None:
        """Copy what was seen last into arrays."""
        np.copyto(rgba, np.asarray(self._seen[COLOR]))
        np.copyto(depth, np.asarray(self._seen[DEPTH]).reshape(depth.shape))
        if SEMANTIC in self._seen:
            np.copyto(labels, np.asarray(self._seen[SEMANTIC]).reshape(labels.shape), casting="unsafe")

    def distances(self, positions: Any, targets: Any) -> Vector:
        """Geodesic distance of each position to its nearest target, by the navigation mesh."""
        return tuple(self._shortest(position, targets)[0] for position in positions)

    def path(self, start: Vector, targets: Any) -> Any:
        """Points of the shortest way to the nearest target, (M, 3)."""
        return self._shortest(np.asarray(start), targets)[1]

    def moves(self, start: Vector, ends: Any, targets: Any) -> Vector:
        """Distance to the nearest target after a straight move to each end, as sliding or stopping bodies move."""
        finder = self._open_sim().pathfinder
        assert self._asked is not None  # noqa: S101 - _open_sim has looked
        step = finder.try_step if self._asked.sliding else finder.try_step_no_sliding
        begin = np.asarray(start, np.float32)
        reached = [np.array(step(begin, np.asarray(end, np.float32)), np.float64) for end in ends]
        return self.distances(reached, targets)

    def close(self) -> None:
        """Free everything."""
        if self._sim is not None:
            self._sim.close()
            self._sim = None

    def _open_sim(self) -> Any:
        if self._sim is None or self._opened is None:
            raise SimulatorError("usage", "No scene is open: send Open first.")
        return self._sim

    def _shortest(self, position: Any, targets: Any) -> Tuple[float, Any]:
        query = self._habitat.MultiGoalShortestPath()
        query.requested_start = np.asarray(position, np.float32)
        query.requested_ends = np.asarray(targets, np.float32)
        found = self._open_sim().pathfinder.find_path(query)
        distance = float(query.geodesic_distance)
        if not found or not math.isfinite(distance):
            return math.inf, np.zeros((0, 3))
        return distance, np.array([np.array(point, np.float64) for point in query.points]).reshape(-1, 3)

    def _view(self, collided: bool) -> View:
        sim = self._open_sim()
        state = sim.get_agent(0).get_state()
        camera = state.sensor_states[DEPTH]
        return View(
            position=_vector(state.position),
            rotation=_coefficients(state.rotation),
            camera_position=_vector(camera.position),
            camera_rotation=_coefficients(camera.rotation),
            collided=collided,
            image=b"",
        )

    def _configuration(self, asked: Open) -> Any:
        habitat = self._habitat
        backend = habitat.SimulatorConfiguration()
        if hasattr(backend, "scene_id"):
            backend.scene_id = asked.scene
        else:  # up to 0.1.6
            backend.scene.id = asked.scene
        if asked.scene_dataset:
            backend.scene_dataset_config_file = asked.scene_dataset
        backend.gpu_device_id = asked.gpu_device
        backend.allow_sliding = asked.sliding
        backend.enable_physics = False
        backend.random_seed = asked.seed
        if hasattr(backend, "load_semantic_mesh"):
            backend.load_semantic_mesh = asked.labels
        kinds = [(COLOR, habitat.SensorType.COLOR), (DEPTH, habitat.SensorType.DEPTH)]
        kinds += [(SEMANTIC, habitat.SensorType.SEMANTIC)] if asked.labels else []
        agent = habitat.agent.AgentConfiguration()
        agent.height, agent.radius = asked.agent_height_m, asked.agent_radius_m
        agent.sensor_specifications = [self._sensor(name, kind, asked) for name, kind in kinds]
        act, amount = habitat.agent.ActionSpec, habitat.agent.ActuationSpec
        agent.action_space = {
            "move_forward": act("move_forward", amount(amount=asked.step_m)),
            "turn_left": act("turn_left", amount(amount=asked.turn_deg)),
            "turn_right": act("turn_right", amount(amount=asked.turn_deg)),
        }
        return habitat.Configuration(backend, [agent])

    def _sensor(self, name: str, kind: Any, asked: Open) -> Any:
        modern = hasattr(self._habitat, "CameraSensorSpec")
        sensor = self._habitat.CameraSensorSpec() if modern else self._habitat.SensorSpec()
        sensor.uuid, sensor.sensor_type = name, kind
        sensor.resolution = [asked.height_px, asked.width_px]
        sensor.position = np.array([0.0, asked.camera_height_m, 0.0], np.float32)
        sensor.orientation = np.zeros(3, np.float32)
        if modern:
            sensor.sensor_subtype = self._habitat.SensorSubType.PINHOLE
            sensor.hfov = asked.hfov_deg
        else:  # 0.1.7 keeps the field of view in a map of strings
            sensor.parameters["hfov"] = str(asked.hfov_deg)
        return sensor

    def _navigation_mesh(self, asked: Open) -> Dict[str, Any]:
        """Compute the mesh with the very settings that were asked for, or take it from the cache; never what lies beside."""
        assert self._sim is not None  # noqa: S101 - made by the caller
        settings, finder = self._mesh_settings(asked), self._sim.pathfinder
        kept = Path(asked.cache) / f"{self._mesh_key(asked)}.navmesh" if asked.cache else None
        cached = kept is not None and kept.exists() and bool(finder.load_nav_mesh(str(kept)))
        if not cached and not self._sim.recompute_navmesh(finder, settings):
            raise SimulatorError("simulator", f"Habitat-Sim found no floor to walk on in {asked.scene!r}: is its up axis y?")
        if not finder.is_loaded:  # asking it anything now would end the process
            raise SimulatorError("simulator", f"Habitat-Sim has no navigation mesh for {asked.scene!r} after computing one.")
        if kept is not None and not cached:
            kept.parent.mkdir(parents=True, exist_ok=True)
            partial = kept.with_suffix(f".{os.getpid()}")
            finder.save_nav_mesh(str(partial))
            partial.replace(kept)
        return {
            "mesh_area_m2": float(finder.navigable_area),
            "mesh_source": "cached" if cached else "computed",
            "mesh_digest": "" if kept is None else _digest(kept),
            "mesh_settings": {name: float(getattr(settings, name)) for name in _MESH_FIELDS},
        }

    def _mesh_settings(self, asked: Open) -> Any:
        settings = self._habitat.NavMeshSettings()
        settings.set_defaults()
        settings.agent_height, settings.agent_radius = asked.agent_height_m, asked.agent_radius_m
        settings.cell_size, settings.cell_height = asked.cell_size_m, asked.cell_height_m
        settings.agent_max_climb, settings.agent_max_slope = asked.max_climb_m, asked.max_slope_deg
        if hasattr(settings, "include_static_objects"):  # from 0.2.5 on; before, it is an argument that is False by default
            settings.include_static_objects = False
        return settings

    def _mesh_key(self, asked: Open) -> str:
        settings = self._mesh_settings(asked)
        text = ",".join(f"{name}={float(getattr(settings, name))!r}" for name in _MESH_FIELDS)
        version = getattr(self._habitat, "__version__", "unknown")
        return hashlib.sha256(f"{_digest(Path(asked.scene))} {version} {text}".encode()).hexdigest()[:32]

    def _categories(self, asked: Open) -> Dict[int, str]:
        if not asked.labels or self._sim is None:
            return {}
        found = {}
        for each in getattr(self._sim.semantic_scene, "objects", []):
            if each is not None and each.category is not None:
                found[int(each.semantic_id)] = str(each.category.name())
        return found


_MESH_FIELDS = ("agent_height", "agent_radius", "cell_size", "cell_height", "agent_max_climb", "agent_max_slope")


def _digest(path: Path) -> str:
    found = hashlib.sha256()
    with path.open("rb") as file:
        for block in iter(lambda: file.read(1 << 20), b""):
            found.update(block)
    return found.hexdigest()


def _vector(value: Any) -> Vector:
    return tuple(float(each) for each in np.array(value).ravel())


def _coefficients(rotation: Any) -> Vector:
    """[x, y, z, w] of a numpy quaternion, or of a Magnum one."""
    if hasattr(rotation, "scalar"):
        return (*_vector(rotation.vector), float(rotation.scalar))
    return (float(rotation.x), float(rotation.y), float(rotation.z), float(rotation.w))
