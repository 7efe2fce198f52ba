"""The paper's robot protocol in embedded houses: six open and six cluttered routes, five across areas; 50 instructions.

The paper's Hall is open, its Office is dense with furniture, and Office-Hall leads from one to the other (appendix "Real-Robot
Experiments"). Here a route is open or cluttered by the room beside its way, and crosses areas by the doors on it. All of a
route lies on one storey, and a robot of the given size fits through all of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from spacevln.core import InstructionTask, Pose, UsageError
from spacevln.environments.houses.episodes import Grounds, HouseEpisode, worded_routes
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.evaluation.episode import Points
from spacevln.evaluation.houses import densify, grounds_of, split_of
from spacevln.evaluation.robot_routes import Route, Routes

OPEN, CLUTTERED, CROSS = "Open", "Cluttered", "Cross-area"
WORDINGS = {OPEN: (3,) * 6, CLUTTERED: (3,) * 6, CROSS: (3, 3, 3, 3, 2)}
"""Language variants of each route, by setting (paper)."""
FITS_M = 0.25
"""Radius of the disc that must fit through a route: more than the simulated robot's guard keeps free around it."""
BESIDE_GOAL_M = (0.0, 0.25, 0.5, 0.75)
"""So near to a goal beside furniture that disc must get, at least."""
OPEN_M, CLUTTERED_M = 0.4, 0.35
"""Median room beside the way, to the nearest obstacle."""
CROSSED_DOORS = 3
"""A route of four metres and more in a house nearly always leads through a doorway; fewer than these stay in one area."""
_ATTEMPTS = 12
_DENSE_M = 0.1


def protocol_routes(first_seed: int, houses: int = 400) -> Routes:
    """The protocol's routes, at most one per setting from each house.

    Args:
        first_seed: of the houses that are looked through.
        houses: most that are.

    Raises:
        UsageError: they do not hold enough routes.
    """
    found: dict[str, list[Route]] = {setting: [] for setting in WORDINGS}
    for seed in range(first_seed, first_seed + houses):
        wanted = [setting for setting in WORDINGS if len(found[setting]) < len(WORDINGS[setting])]
        if not wanted:
            break
        for setting, episodes in _of_house(grounds_of(seed), wanted):
            number = len(found[setting])
            found[setting].append(_route(setting, number, episodes[: WORDINGS[setting][number]]))
    else:
        raise UsageError(
            f"The houses {first_seed}:{first_seed + houses} do not hold the protocol's routes: begin at another seed."
        )
    return Routes(name=f"houses-{first_seed}", routes=tuple(route for setting in WORDINGS for route in found[setting]))


def write_routes(routes: Routes, path: Path) -> None:
    """Write a routes file.

    Raises:
        UsageError: it cannot be written.
    """
    from ruamel.yaml import YAML

    yaml = YAML()
    yaml.width = 4096
    try:
        with path.open("w", encoding="utf-8") as file:
            yaml.dump(routes.model_dump(mode="json", exclude_none=True), file)
    except OSError as error:
        raise UsageError(f"The routes cannot be written to {str(path)!r} ({error.strerror}): give another path.") from error


def _of_house(grounds: Grounds, wanted: Sequence[str]) -> Iterator[tuple[str, tuple[HouseEpisode, ...]]]:
    wide, left = Geodesics(grounds.walkable, FITS_M), set(wanted)
    for episodes in worded_routes(grounds, split_of(grounds.house.seed), max(map(max, WORDINGS.values())), _ATTEMPTS):
        setting = _setting(grounds, wide, episodes[0])
        if setting in left:
            left.remove(setting)
            yield setting, episodes
        if not left:
            return


def _setting(grounds: Grounds, wide: Geodesics, episode: HouseEpisode) -> str | None:
    """Which setting a route belongs to; None for neither, or where the robot does not fit."""
    start, goal = episode.spec.start, episode.goals[0]
    if episode.tags.floors > 1:
        return None
    path = _wide_path(wide, start, goal)
    floor = grounds.walkable.floors[grounds.walkable.floor_index(start.x_m, start.y_m, start.z_m)]
    if len(path) < 2 or floor.clearance_m[floor.cell(start.x_m, start.y_m)] < FITS_M:
        return None
    if episode.tags.doors >= CROSSED_DOORS:
        return CROSS
    room_m = float(np.median([floor.clearance_m[floor.cell(float(x), float(y))] for x, y, _ in densify(path, _DENSE_M)]))
    return OPEN if room_m >= OPEN_M else CLUTTERED if room_m < CLUTTERED_M else None


def _wide_path(wide: Geodesics, start: Pose, goal: tuple[float, float, float]) -> Points:
    """The robot's way to the goal or beside it; empty where it does not fit."""
    field, (x, y, z) = wide.distances_from([start.position_m]), goal
    for away_m in BESIDE_GOAL_M:
        for angle in np.linspace(0, 2 * math.pi, 8, endpoint=False):
            path = field.path(x + away_m * math.cos(angle), y + away_m * math.sin(angle), z)
            if len(path) > 1:
                return path
    return np.zeros((0, 3))


def _route(setting: str, number: int, episodes: Sequence[HouseEpisode]) -> Route:
    spec, goal = episodes[0].spec, episodes[0].goals[0]
    start = spec.start
    return Route(
        id=f"{setting.lower()}-{number + 1}",
        setting=setting,
        instructions=tuple(e.spec.task.instruction for e in episodes if isinstance(e.spec.task, InstructionTask)),
        goal_m=goal[:2],
        scene=spec.scene,
        start=(start.x_m, start.y_m, start.z_m, start.yaw_rad),
    )
