"""A navigation mesh of triangles that moves and measures as Detour does; only flat islands, as in the recorded house."""

import math

import numpy as np

EPS = 1e-5
_BLOCK = 4
_SHARES = np.linspace(0.001, 0.999, 61)


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


class Mesh:
    def __init__(self, vertices, triangles):
        points = np.array(vertices, np.float64)
        keys = {}
        self.index = np.array([keys.setdefault(tuple(np.round(p, 4)), len(keys)) for p in points])[np.array(triangles)]
        self.points = np.array(list(keys), np.float64)
        first = {index: points[i] for i, index in reversed(list(enumerate(self.index_of(points, keys))))}
        self.points = np.array([first[i] for i in range(len(keys))])
        self.corners = self.points[self.index]
        self.flat = self.corners[..., [0, 2]]
        sign = cross(self.flat[:, 1] - self.flat[:, 0], self.flat[:, 2] - self.flat[:, 0])
        self.flat[sign < 0] = self.flat[sign < 0][:, ::-1]
        self.index[sign < 0] = self.index[sign < 0][:, ::-1]
        edges = {}
        for t, (a, b, c) in enumerate(self.index.tolist()):
            for e, pair in enumerate(((a, b), (b, c), (c, a))):
                edges.setdefault(frozenset(pair), []).append((t, e))
        self.neighbour = -np.ones((len(self.index), 3), int)
        for sides in edges.values():
            if len(sides) == 2:
                (t, e), (u, f) = sides
                self.neighbour[t, e], self.neighbour[u, f] = u, t
        self.island = self._islands()
        walls = [(t, e) for t in range(len(self.index)) for e in range(3) if self.neighbour[t, e] < 0]
        self.wall_island = np.array([self.island[t] for t, _ in walls])
        self.walls = np.array([[self.flat[t, e], self.flat[t, (e + 1) % 3]] for t, e in walls])
        self._graphs, self._ends, self._planes = {}, {}, {}

    @staticmethod
    def index_of(points, keys):
        return [keys[tuple(np.round(p, 4))] for p in points]

    def _islands(self):
        island = -np.ones(len(self.index), int)
        for seed in range(len(island)):
            if island[seed] >= 0:
                continue
            waiting, island[seed] = [seed], island.max() + 1
            while waiting:
                for other in self.neighbour[waiting.pop()]:
                    if other >= 0 and island[other] < 0:
                        island[other] = island[seed]
                        waiting.append(other)
        return island

    def nearest(self, point):
        """Triangle and point of the mesh nearest to a point, within Habitat's extents of 2 m sideways and 4 m in height."""
        xz = np.array([point[0], point[2]], np.float64)
        p, along = self.flat, np.roll(self.flat, -1, 1) - self.flat
        share = np.clip(((xz - p) * along).sum(2) / (along * along).sum(2), 0.0, 1.0)
        edge = p + along * share[..., None]
        closest = np.argmin(((edge - xz) ** 2).sum(2), axis=1)
        near = edge[np.arange(len(edge)), closest]
        inside = (cross(along, xz - p) >= -1e-9).all(axis=1)
        near[inside] = xz
        off, rise = near - xz, self.corners[:, 0, 1] - point[1]
        gap = np.where((np.abs(off).max(axis=1) <= 2.0) & (np.abs(rise) <= 4.0), (off * off).sum(1) + rise * rise, math.inf)
        t = int(np.argmin(gap))
        if not math.isfinite(gap[t]):
            return -1, np.full(3, np.nan)
        return t, np.array([near[t, 0], self.corners[t, 0, 1], near[t, 1]])

    def _inside(self, t, xz, slack=1e-9):
        corner = self.flat[t]
        return bool((cross(np.roll(corner, -1, 0) - corner, xz - corner) >= -slack).all())

    def slide(self, start, end):
        """Detour's moveAlongSurface: the reachable point nearest to the end."""
        first, begin = self.nearest(start)
        if first < 0:
            return np.array(start, np.float64)
        height = begin[1]
        a, b = begin[[0, 2]], np.array([end[0], end[2]], np.float64)
        middle, reach = (a + b) / 2, np.linalg.norm(b - a) / 2 + 1e-3
        waiting, seen, best, near = [first], {first}, a, math.inf
        while waiting:
            t = waiting.pop(0)
            if self._inside(t, b):
                best = b
                break
            for e in range(3):
                p, q, other = self.flat[t, e], self.flat[t, (e + 1) % 3], self.neighbour[t, e]
                if other < 0:
                    on = _on(b, p, q)
                    distance = float(np.sum((on - b) ** 2))
                    if distance < near:
                        best, near = on, distance
                elif other not in seen and np.linalg.norm(_on(middle, p, q) - middle) <= reach:
                    seen.add(other)
                    waiting.append(other)
        return np.array([best[0], height, best[1]])

    def halt(self, start, end):
        """Go straight until a wall."""
        first, begin = self.nearest(start)
        a, b = begin[[0, 2]], np.array([end[0], end[2]], np.float64)
        walls = self.walls[self.wall_island == self.island[first]]
        along, edge, gap = b - a, walls[:, 1] - walls[:, 0], walls[:, 0] - a
        with np.errstate(divide="ignore", invalid="ignore"):
            facing = cross(along, edge)
            t, s = cross(gap, edge) / facing, cross(gap, along) / facing
        hits = t[(np.abs(facing) > 1e-12) & (t > 1e-6) & (t < 1) & (s > -1e-9) & (s < 1 + 1e-9)]
        reached = a + along * (hits.min() if len(hits) else 1.0)
        if not any(self._inside(t, reached, 1e-6) for t in np.flatnonzero(self.island == self.island[first])):
            reached = a
        return np.array([reached[0], begin[1], reached[1]])

    def _visible(self, island, a, others):
        """Whether straight lines from a to others stay on an island."""
        walls = self.walls[self.wall_island == island]
        p, q = walls[None, :, 0], walls[None, :, 1]
        b = others[:, None]
        d1, d2 = cross(q - p, a - p), cross(q - p, b - p)
        d3, d4 = cross(b - a, p - a), cross(b - a, q - a)
        blocked = ((d1 * d2 < -1e-10) & (d3 * d4 < -1e-10)).any(axis=1)
        free = np.flatnonzero(~blocked)
        normals, offsets = self._sides(island)
        at = a + _SHARES[:, None, None] * (others[free] - a)
        inside = (at.reshape(-1, 2) @ normals - offsets >= -1e-6).reshape(-1, 3, len(offsets) // 3).all(axis=1).any(axis=1)
        free = free[inside.reshape(len(_SHARES), -1).all(axis=0)]
        seen = np.zeros(len(others), bool)
        seen[free] = True
        return seen

    def _sides(self, island):
        """Half planes of an island's triangles: normals (2, 3T) and offsets (3T,), side by side."""
        if island not in self._planes:
            mesh = self.flat[self.island == island]
            along = np.roll(mesh, -1, 1) - mesh
            normals = np.stack([-along[..., 1], along[..., 0]])
            self._planes[island] = (
                normals.transpose(0, 2, 1).reshape(2, -1),
                (normals[0] * mesh[..., 0] + normals[1] * mesh[..., 1]).T.ravel(),
            )
        return self._planes[island]

    def _graph(self, island):
        if island not in self._graphs:
            nodes = np.unique(self.walls[self.wall_island == island].reshape(-1, 2), axis=0)
            gaps = np.linalg.norm(nodes[:, None] - nodes[None], axis=2)
            seen = np.array([self._visible(island, node, nodes) for node in nodes])
            self._graphs[island] = nodes, np.where(seen & seen.T, gaps, np.inf)
        return self._graphs[island]

    def path(self, start, end):
        """Length and corners of the shortest way; inf where there is none. Ends over the mesh keep their height, as Detour's do."""
        _, corners = self._flat_path(start, end)
        if not corners:
            return math.inf, []
        for at, asked in ((0, start), (-1, end)):
            if np.allclose(corners[at][[0, 2]], [asked[0], asked[2]], atol=1e-6):
                corners[at] = np.array(asked, np.float64)
        return float(sum(np.linalg.norm(b - a) for a, b in zip(corners, corners[1:]))), corners

    def _flat_path(self, start, end):
        t, a = self.nearest(start)
        u, b = self.nearest(end)
        if t < 0 or u < 0 or self.island[t] != self.island[u]:
            return math.inf, []
        island, height = self.island[t], a[1]
        a, b = a[[0, 2]], b[[0, 2]]
        if self._visible(island, a, b[None])[0]:
            return float(np.linalg.norm(b - a)), [_lift(a, height), _lift(b, height)]
        nodes, cost, after = self._ways_to(island, b)
        total = np.linalg.norm(nodes - a, axis=1) + cost
        order = np.argsort(total)
        for block in np.split(order, range(_BLOCK, len(order), _BLOCK)):  # the first that is seen is the best
            seen = block[self._visible(island, a, nodes[block])]
            if len(seen) and np.isfinite(total[seen[0]]):
                at, corners = int(seen[0]), [a]
                while at >= 0:
                    corners.append(nodes[at])
                    at = int(after[at])
                return float(total[seen[0]]), [_lift(p, height) for p in [*corners, b]]
        return math.inf, []

    def _ways_to(self, island, b):
        """Corners of an island, how far each is from b, and which comes next on the way; -1 where b does."""
        key = (int(island), *b.tolist())
        if key not in self._ends:
            nodes, weights = self._graph(island)
            cost = np.where(self._visible(island, b, nodes), np.linalg.norm(nodes - b, axis=1), np.inf)
            after, done = -np.ones(len(nodes), int), np.zeros(len(nodes), bool)
            for _ in range(len(nodes)):
                at = int(np.argmin(np.where(done, np.inf, cost)))
                done[at] = True
                shorter = cost[at] + weights[at] < cost - 1e-12
                cost = np.where(shorter, cost[at] + weights[at], cost)
                after[shorter] = at
            self._ends[key] = nodes, cost, after
        return self._ends[key]


def _on(point, p, q):
    along = q - p
    return p + along * min(1.0, max(0.0, float((point - p) @ along) / float(along @ along)))


def _lift(p, height):
    return np.array([p[0], height, p[1]])
