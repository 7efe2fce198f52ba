"""The simulator: moves over an occupancy map, measures on it, draws."""

import heapq
import json
import math
import types
from pathlib import Path

import cv2
import numpy as np
from habitat_sim import COARSE
from habitat_sim._draw import draw

HOUSE = dict(np.load(str(Path(__file__).resolve().parents[3] / "data" / "house.npz")))
MARGINS = [7, 6, 5, 4]
NEIGHBOURS = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]


def grow(free, margin):
    """Free pixels farther than a margin from every blocked one."""
    height, width = free.shape
    wide = np.pad(~free, margin)
    grown = np.zeros_like(free)
    for v in range(-margin, margin + 1):
        for u in range(-margin, margin + 1):
            if u * u + v * v <= margin * margin:
                grown |= wide[margin + v : margin + v + height, margin + u : margin + u + width]
    return ~grown


def line(a, b):
    (x, y), found = a, [a]
    dx, dy = abs(b[0] - x), abs(b[1] - y)
    sx, sy = (1 if b[0] >= x else -1), (1 if b[1] >= y else -1)
    rest = max(dx, dy) // 2
    while (x, y) != b:
        rest -= min(dx, dy)
        if dx >= dy:
            x += sx
            if rest < 0:
                y, rest = y + sy, rest + dx
        else:
            y += sy
            if rest < 0:
                x, rest = x + sx, rest + dy
        found.append((x, y))
    return found


class GNBenchSim:
    def __init__(self, config):
        self.config = config
        self.agent_state = types.SimpleNamespace(position=None, rotation=None)
        self.gaussians = None
        self.trajectory = []

    def reconfigure(self, config, actor_seq_dir=""):
        scene = Path(config.SCENE)
        reference = json.loads(Path(config.REF_JSON).read_text())
        self.place = json.loads((scene / "occupancy.json").read_text())
        gray = cv2.imread(str(scene / "occupancy.png"), cv2.IMREAD_UNCHANGED)
        assert gray.ndim == 2, "Only 8-bit grayscale PNGs are supported"
        self.height, self.width = gray.shape
        self.grids = {margin: grow(gray >= 200, margin) for margin in MARGINS}
        (scene / "3dgs_compressed.ply").read_bytes()
        self.gaussians = types.SimpleNamespace(get_xyz=np.zeros((len(HOUSE["triangles"]), 3), np.float32))
        self._fit(reference["path"])
        start = reference["start"]["world"]
        heading = math.radians(reference["start_facing"]["world"]["heading_degrees"])
        self.agent_state.position = np.array([start["x"], start["y"], 1.3], np.float32)
        self.agent_state.rotation = np.array([0, 0, math.sin(heading / 2), math.cos(heading / 2)])
        print("Loading scene: %s" % scene)

    def _fit(self, path):
        """Where the splats are: a straight fit of the map's own coordinates over the reference's, each axis by itself."""
        scale, left, top = self.place["scale"], self.place["min"][0], self.place["max"][1]
        world = np.array([[p["x"], p["y"]] for p in path["raster_world"]])
        own = np.array([[left + px * scale, top - py * scale] for px, py in path["raster_pixel"]])
        self.fit = [np.polyfit(world[:, k], own[:, k], 1) for k in (0, 1)]
        self.middle = np.array([left + self.width * scale / 2, top - self.height * scale / 2])

    def seed(self, seed):
        np.random.seed(seed)

    def close(self):
        pass

    def get_agent_state(self, agent_id=0):
        return self.agent_state

    def set_agent_state(self, position, rotation, agent_id=0, reset_sensors=True):
        self.agent_state.position, self.agent_state.rotation = position, rotation
        return True

    def reset(self):
        self.trajectory = [self.pixel(self.agent_state.position)]
        return self.get_sensor_observations()

    def step(self, action):
        state, before = self.agent_state, np.array(self.agent_state.position)
        yaw = 2 * math.atan2(state.rotation[2], state.rotation[3])
        if action == 1:
            state.position = before + np.array([math.cos(yaw), math.sin(yaw), 0]) * self.config.FORWARD_STEP_SIZE
            if self.config.COLLIDABLE:
                state.position = self._clipped(before, state.position)
            self.trajectory.append(self.pixel(state.position))
        elif action in (2, 3):
            yaw += math.radians(self.config.TURN_ANGLE) * (1 if action == 2 else -1)
            state.rotation = np.array([0, 0, math.sin(yaw / 2), math.cos(yaw / 2)])
        return self.get_sensor_observations()

    def _clipped(self, before, after):
        """The middle of the last free pixel of the line, where the line is not free."""
        grid, last = self.grids[MARGINS[-1]], self.pixel(before)
        if last == self.pixel(after):
            return after
        for x, y in line(last, self.pixel(after)):
            if not grid[y][x]:
                return np.array([*self.world(last), before[2]], np.float32)
            last = (x, y)
        return after

    # --- the map

    def _sizes(self):
        lower, upper = self.place["lower"], self.place["upper"]
        return (upper[0] - lower[0]) / self.width, (upper[1] - lower[1]) / self.height

    def pixel(self, position):
        sx, sy = self._sizes()
        x = round((-float(position[0]) - self.place["lower"][0]) / sx - 0.5)
        y = round((self.place["upper"][1] + float(position[1])) / sy - 0.5)
        return max(0, min(x, self.width - 1)), max(0, min(y, self.height - 1))

    def world(self, pixel):
        sx, sy = self._sizes()
        return -(self.place["lower"][0] + (pixel[0] + 0.5) * sx), -(self.place["upper"][1] - (pixel[1] + 0.5) * sy)

    def _nearest(self, pixel):
        grid, (x, y) = self.grids[MARGINS[-1]], pixel
        if grid[y][x]:
            return pixel
        for r in range(1, max(self.width, self.height)):
            left, right, top, bottom = max(x - r, 0), min(x + r, self.width - 1), max(y - r, 0), min(y + r, self.height - 1)
            ring = [(u, v) for u in range(left, right + 1) for v in (top, bottom)]
            ring += [(u, v) for v in range(top + 1, bottom) for u in (left, right)]
            for u, v in ring:
                if grid[v][u]:
                    return u, v
        return pixel

    def geodesic_distance(self, a, goals):
        """To the nearest of some goals; here only for comparison."""
        start, best = self._nearest(self.pixel(a)), math.inf
        for goal in goals:
            end = self._nearest(self.pixel(goal))
            if start == end:
                return 0.0
            way = next(filter(None, (self._search(start, end, self.grids[margin]) for margin in MARGINS)), None)
            if way:
                points = [self.world(pixel) for pixel in self._dense(self._smooth(way))]
                best = min(best, sum(math.dist(p, q) for p, q in zip(points, points[1:])))
        return best

    def _search(self, start, end, grid):
        cost, before, waiting = {start: 0.0}, {}, [(math.dist(start, end), start)]
        while waiting:
            _, at = heapq.heappop(waiting)
            if at == end:
                way = [at]
                while at in before:
                    at = before[at]
                    way.append(at)
                return way[::-1]
            for dx, dy in NEIGHBOURS:
                u, v = at[0] + dx, at[1] + dy
                if not (0 <= u < self.width and 0 <= v < self.height and grid[v][u]):
                    continue
                if dx and dy and not (grid[at[1]][u] and grid[v][at[0]]):
                    continue
                longer = cost[at] + math.hypot(dx, dy)
                if longer < cost.get((u, v), math.inf):
                    cost[u, v], before[u, v] = longer, at
                    heapq.heappush(waiting, (longer + math.hypot(u - end[0], v - end[1]), (u, v)))
        return None

    def _smooth(self, way):
        grid, kept, at = self.grids[MARGINS[0]], [way[0]], 0
        while at < len(way) - 1:
            at = next(
                (k for k in range(len(way) - 1, at, -1) if all(grid[y][x] for x, y in line(way[at], way[k]))),
                at + 1,
            )
            kept.append(way[at])
        return kept

    @staticmethod
    def _dense(nodes):
        found = [nodes[0]]
        for a, b in zip(nodes, nodes[1:]):
            found += line(a, b)[1:]
        return found

    # --- pictures

    def get_sensor_observations(self):
        images = {}
        for name in self.config.AGENT_0.SENSORS:
            camera = getattr(self.config, name)
            color, depth = self._drawn(camera)
            if name == "RGB_SENSOR":
                images["rgb"] = color[..., :3]
            else:
                images["depth"] = self._as_asked(depth, camera)[..., None]
        return images

    def _as_asked(self, depth, camera):
        far = np.where(depth > 0, depth, np.finfo(np.float32).max)
        if camera.NORMALIZE_DEPTH:
            return np.clip((far - camera.MIN_DEPTH) / (camera.MAX_DEPTH - camera.MIN_DEPTH), 0, 1).astype(np.float32)
        return np.clip(far, camera.MIN_DEPTH, camera.MAX_DEPTH).astype(np.float32)

    def _drawn(self, camera):
        """As from the fitted place; the number that is called horizontal is the vertical field of view."""
        x, y, z = (float(each) for each in self.agent_state.position)
        fitted = 2 * self.middle - [np.polyval(self.fit[0], x), np.polyval(self.fit[1], y)]
        sx, sy = self._sizes()
        x, y = fitted - [sx / 2, -sy / 2]  # the splats of the house lie by the map, whose pixels have middles
        yaw = 2 * math.atan2(self.agent_state.rotation[2], self.agent_state.rotation[3])
        turn = np.array([[math.cos(yaw), 0, math.sin(yaw)], [0, 1, 0], [-math.sin(yaw), 0, math.cos(yaw)]])
        wide = 2 * math.degrees(math.atan(math.tan(math.radians(camera.HFOV) / 2) * camera.WIDTH / camera.HEIGHT))
        color, depth, _ = draw(HOUSE, np.array([-y, z, -x]), turn, camera.WIDTH // COARSE, camera.HEIGHT // COARSE, wide)
        return [each.repeat(COARSE, 0).repeat(COARSE, 1) for each in (color, depth)]
