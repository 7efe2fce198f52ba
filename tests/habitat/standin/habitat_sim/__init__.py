"""A stand-in for habitat_sim with the house and the habits that were recorded from the real one (../../data/README.md).

HABITAT_STANDIN chooses the version, "0.2.2" or "0.3.4"; they differ where the records differ: types of vectors, when a navigation mesh is
made, moves without sliding. Attributes that the real classes do not have are refused, as theirs are. HABITAT_STANDIN_FAULT makes it misbehave ("kill", "stop" or "garbage" at "import", "open", "look" or "step": "kill-open") or draw nothing, HABITAT_STANDIN_COARSE
draws only every so many pixels, for tests that look at nothing fine.
"""

import gzip
import json
import math
import os
import signal
import sys
import time
import types
from pathlib import Path

import numpy as np

from habitat_sim._draw import draw
from habitat_sim._mesh import EPS, Mesh

VERSION = os.environ.get("HABITAT_STANDIN", "0.3.4")
__version__ = {"0.3.4": "0.3.3", "0.2.2": "0.2.2"}[VERSION]  # upstream did not raise it at 0.3.4
MODERN = VERSION == "0.3.4"
FAULT = os.environ.get("HABITAT_STANDIN_FAULT", "")
COARSE = int(os.environ.get("HABITAT_STANDIN_COARSE", "1"))
DATA = Path(__file__).resolve().parents[2] / "data"
RECORDS = json.loads(gzip.decompress((DATA / "records.json.gz").read_bytes()).decode())
HOUSE = dict(np.load(str(DATA / "house.npz")))


class _Meshes(dict):
    """Navigation meshes by name, made when they are first asked for."""

    def __missing__(self, name):
        each = RECORDS["meshes"][name]
        self[name] = Mesh(each["vertices"], each["triangles"])
        return self[name]


MESHES = _Meshes()
_LIVING = []


def _moment(name):
    """Misbehave, if this is the moment to."""
    if "kill-" + name == FAULT:
        os.kill(os.getpid(), signal.SIGKILL)
    if "stop-" + name == FAULT:
        os.kill(os.getpid(), signal.SIGSTOP)
    if "garbage-" + name == FAULT:
        os.write(int(sys.argv[sys.argv.index("--channel") + 1]), b"Segmentation fault (core dumped)\n")


_moment("import")


def _key(position, yaw_rad):
    return (*(round(float(each), 4) for each in position), round(math.degrees(yaw_rad)) % 360)


def _moves():
    """Recorded forward moves without sliding, whose rule differs between versions."""
    found = {}
    for trace in RECORDS["traces"]["034" if MODERN else "022"].values():
        for before, after in zip(trace["steps"], trace["steps"][1:]):
            if after[0] == 1 and not trace["sliding"]:
                yaw = 2 * math.atan2(before[2][1], before[2][3])
                found[(trace["navmesh"], *_key(before[1], yaw))] = after[1]
    return found


_HALTS = {}


def halts():
    """Those moves, read when they are first asked for."""
    if not _HALTS:
        _HALTS.update(_moves())
    return _HALTS


def take(value):
    """A vector as the bindings of this version take it."""
    if MODERN:
        if isinstance(value, Vector3):
            return value.values
        if isinstance(value, (list, tuple)) and any(isinstance(each, int) for each in value):
            raise TypeError("incompatible function arguments: a list with int")
    if isinstance(value, np.ndarray) and value.dtype.kind != "f":
        raise TypeError("incompatible function arguments: %s" % value.dtype)
    array = np.asarray(value, np.float32)
    if array.shape != (3,):
        raise TypeError("incompatible function arguments: shape %s" % (array.shape,))
    return array


class Vector3:
    """Magnum-like: no array, but becomes one."""

    def __init__(self, values):
        self.values = np.asarray(values, np.float32)

    def __array__(self, dtype=None, copy=None):
        return self.values.astype(dtype or np.float32)

    def __getitem__(self, index):
        return float(self.values[index])

    def __len__(self):
        return 3


def give(values):
    """A vector as the bindings of this version give it."""
    return Vector3(values) if MODERN else np.asarray(values, np.float32)


class Deg:
    """Magnum's angle."""

    def __init__(self, value):
        self._value = float(value)

    def __float__(self):
        return self._value


class Quaternion:
    """As numpy-quaternion: w, x, y, z."""

    def __init__(self, w, x, y, z):
        self.w, self.x, self.y, self.z = (float(each) for each in (w, x, y, z))

    def __mul__(self, o):
        return Quaternion(
            self.w * o.w - self.x * o.x - self.y * o.y - self.z * o.z,
            self.w * o.x + self.x * o.w + self.y * o.z - self.z * o.y,
            self.w * o.y - self.x * o.z + self.y * o.w + self.z * o.x,
            self.w * o.z + self.x * o.y - self.y * o.x + self.z * o.w,
        )

    def matrix(self):
        w, x, y, z = self.w, self.x, self.y, self.z
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )


class Strict:
    """Refuses attributes that were not there at first."""

    FIELDS = {}

    def __init__(self, **given):
        for name, value in self.FIELDS.items():
            object.__setattr__(self, name, value)
        for name, value in given.items():
            setattr(self, name, value)

    def __setattr__(self, name, value):
        if name not in self.FIELDS:
            raise AttributeError("%s has no attribute %r" % (type(self).__name__, name))
        object.__setattr__(self, name, value)


class SimulatorConfiguration(Strict):
    FIELDS = {
        "scene_id": "NONE",
        "scene_dataset_config_file": "default",
        "gpu_device_id": 0,
        "allow_sliding": True,
        "enable_physics": False,
        "random_seed": 0,
        "load_semantic_mesh": True,
        **({"navmesh_settings": None} if MODERN else {}),
    }


class CameraSensorSpec(Strict):
    FIELDS = {
        "uuid": "",
        "sensor_type": None,
        "sensor_subtype": None,
        "resolution": [84, 84],
        "position": give([0, 1.5, 0]),
        "orientation": give([0, 0, 0]),
        "hfov": Deg(90),
        "near": 0.01,
        "far": 1000.0,
    }

    def __setattr__(self, name, value):
        if name in ("position", "orientation"):
            value = give(take(value))
        super().__setattr__(name, Deg(value) if name == "hfov" else value)


class NavMeshSettings(Strict):
    FIELDS = {**RECORDS["meshes"]["r010"]["settings"], "agent_height": 1.5}
    if not MODERN:
        FIELDS.pop("include_static_objects")

    def set_defaults(self):
        """As constructed."""


class AgentState:
    def __init__(self, position=None, rotation=None):
        self.position = np.zeros(3, np.float32) if position is None else position
        self.rotation = rotation or Quaternion(1, 0, 0, 0)
        self.sensor_states = {}


class SensorType:
    COLOR, DEPTH, SEMANTIC = "color", "depth", "semantic"


class SensorSubType:
    PINHOLE = "pinhole"


class ActuationSpec:
    def __init__(self, amount):
        self.amount = amount


class ActionSpec:
    def __init__(self, name, actuation):
        self.name, self.actuation = name, actuation


class AgentConfiguration:
    def __init__(self, height=1.5, radius=0.1, sensor_specifications=None, action_space=None):
        self.height, self.radius = height, radius
        self.sensor_specifications, self.action_space = sensor_specifications or [], action_space or {}


class Configuration:
    def __init__(self, sim_cfg, agents):
        self.sim_cfg, self.agents = sim_cfg, agents


class ShortestPath:
    def __init__(self):
        self.requested_start, self._ends = None, []
        self.points, self.geodesic_distance = [], math.inf


class MultiGoalShortestPath(ShortestPath):
    @property
    def requested_ends(self):
        return self._ends

    @requested_ends.setter
    def requested_ends(self, ends):
        self._ends = [take(end) for end in ends]


class PathFinder:
    def __init__(self):
        self.name, self.nav_mesh_settings = None, None

    @property
    def is_loaded(self):
        return self.name is not None

    @property
    def navigable_area(self):
        return RECORDS["meshes"][self.name]["area"] if self.name else 0.0

    def seed(self, seed):
        assert isinstance(seed, int)

    def _mesh(self):
        if self.name is None:
            os.abort()  # the real one ends the process, and nothing can be caught
        return MESHES[self.name]

    def is_navigable(self, point, max_y_delta=0.5):
        _, near = self._mesh().nearest(take(point))
        return bool(np.hypot(*(near - take(point))[[0, 2]]) < 1e-2 and abs(near[1] - take(point)[1]) < max_y_delta)

    def snap_point(self, point):
        return give(self._mesh().nearest(take(point))[1])

    def try_step(self, start, end):
        return give(self._mesh().slide(take(start), take(end)))

    def try_step_no_sliding(self, start, end):
        begin, wanted = take(start), take(end)
        yaw = math.atan2(-(wanted - begin)[0], -(wanted - begin)[2])
        known = halts().get((self.name, *_key(begin, yaw)))
        return give(known if known is not None else self._mesh().halt(begin, wanted))

    def find_path(self, query):
        mesh, start = self._mesh(), take(query.requested_start)
        found = [mesh.path(start, end) for end in query.requested_ends]
        query.geodesic_distance, points = min(found, key=lambda each: each[0])
        query.points = [give(point) for point in points]
        return math.isfinite(query.geodesic_distance)

    def save_nav_mesh(self, path):
        Path(path).write_text(self.name)
        return True

    def load_nav_mesh(self, path):
        self.name = Path(path).read_text()
        return True


class _Agent:
    def __init__(self, config):
        self.agent_config, self.state = config, AgentState()

    def set_state(self, state):
        self.state = AgentState(take(state.position), state.rotation)

    def get_state(self):
        turn, found = self.state.rotation, AgentState(give(self.state.position), self.state.rotation)
        for sensor in self.agent_config.sensor_specifications:
            offset = turn.matrix() @ np.asarray(sensor.position, np.float64)
            found.sensor_states[sensor.uuid] = types.SimpleNamespace(
                position=give(self.state.position + offset.astype(np.float32)), rotation=turn
            )
        return found


class _Thing:
    def __init__(self, number, name):
        self.semantic_id = number
        self.category = types.SimpleNamespace(name=lambda: name)


class Simulator:
    def __init__(self, config):
        if _LIVING:
            os.abort()  # one GL context in a process
        if config.sim_cfg.gpu_device_id != -1:
            sys.stderr.write("stand-in: no GPU\n")
            os._exit(1)
        _LIVING.append(self)
        self.pathfinder = PathFinder()
        self.semantic_scene = types.SimpleNamespace(
            objects=[_Thing(n, name.rsplit("_", 1)[0]) for n, name in enumerate(RECORDS["names"], 1)]
        )
        self.reconfigure(config)

    def reconfigure(self, config):
        _moment("open")
        self.config, self._agent, self._blank = config, _Agent(config.agents[0]), {}
        self.pathfinder.name = None
        if not MODERN:
            self.pathfinder.name = "r010"
        if FAULT == "hang":
            time.sleep(1000)

    def seed(self, seed):
        assert isinstance(seed, int)

    def close(self):
        _LIVING.remove(self)

    def get_agent(self, index):
        assert index == 0
        return self._agent

    def recompute_navmesh(self, pathfinder, settings, *include_static_objects):
        if MODERN and include_static_objects:
            raise TypeError("recompute_navmesh takes 2 arguments")
        radius = "r018" if settings.agent_radius > 0.14 else "r010"
        pathfinder.name = "r018_fine" if radius == "r018" and settings.cell_height < 0.1 else radius
        return True

    def step(self, action):
        _moment("step")
        agent, spec = self._agent, self._agent.agent_config.action_space[action]
        collided, amount = False, spec.actuation.amount
        if spec.name == "move_forward":
            ahead = agent.state.rotation.matrix() @ np.array([0.0, 0.0, -1.0])
            begin = agent.state.position
            wanted = (begin + (ahead * amount).astype(np.float32)).astype(np.float32)
            finder = self.pathfinder
            reached = (
                finder.try_step(begin, wanted) if self.config.sim_cfg.allow_sliding else finder.try_step_no_sliding(begin, wanted)
            )
            agent.state.position = np.asarray(reached, np.float32)
            collided = bool(np.linalg.norm(agent.state.position - begin) + EPS < np.linalg.norm(wanted - begin))
        else:
            half = math.radians(amount) / 2 * (1 if spec.name == "turn_left" else -1)
            agent.state.rotation = agent.state.rotation * Quaternion(math.cos(half), 0, math.sin(half), 0)
        if FAULT == "die" and collided:
            os._exit(139)
        seen = self.get_sensor_observations()
        seen["collided"] = collided
        return seen

    def get_sensor_observations(self):
        _moment("look")
        state, sensors = self._agent.get_state(), self._agent.agent_config.sensor_specifications
        first = sensors[0]
        height, width = first.resolution
        eye = np.asarray(state.sensor_states[first.uuid].position, np.float64)
        if FAULT == "blank":  # the same ones each time: what they cost is no part of what is measured with them
            if not self._blank:
                blank = {"color": (4, np.uint8), "depth": (1, np.float32), "semantic": (1, np.uint32)}
                shapes = {kind: ((height, width, n) if n > 1 else (height, width), dtype) for kind, (n, dtype) in blank.items()}
                self._blank.update({s.uuid: np.ones(*shapes[s.sensor_type]) for s in sensors})
            return dict(self._blank)
        drawn = draw(HOUSE, eye, state.rotation.matrix(), width // COARSE, height // COARSE, first.hfov)
        images = dict(zip(("color", "depth", "semantic"), (each.repeat(COARSE, 0).repeat(COARSE, 1) for each in drawn)))
        return {sensor.uuid: images[sensor.sensor_type] for sensor in sensors}


agent = types.SimpleNamespace(AgentConfiguration=AgentConfiguration, ActionSpec=ActionSpec, ActuationSpec=ActuationSpec)
utils = types.SimpleNamespace(common=types.SimpleNamespace(quat_from_coeffs=lambda q: Quaternion(q[3], q[0], q[1], q[2])))
