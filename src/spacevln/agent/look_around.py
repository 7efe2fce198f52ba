"""LookAround(): the 12-view panorama O^12_k (Algorithm 1 line 3; 8 views on a robot)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from spacevln.agent.body import Body, Phase
from spacevln.agent.world import World
from spacevln.core import Action, Observation, Sighting, TurnLeft, View, egocentric_label, wrap_angle


@dataclass(frozen=True, slots=True, eq=False)
class Panorama:
    """One look-around: the posed images, and the views made of them, both counter-clockwise from the front."""

    observations: tuple[Observation, ...]
    views: tuple[View, ...]

    @property
    def sightings(self) -> tuple[Sighting, ...]:
        """Sightings of all views."""
        return tuple(sighting for view in self.views for sighting in view.sightings)

    def heading_rad(self, label: str) -> float:
        """Egocentric heading alpha_i of the view with this label."""
        return next(view.heading_rad for view in self.views if view.label == label)


def look_around(body: Body, world: World, turns: Sequence[Action], terms: Sequence[str]) -> Panorama:
    """Turn, and detect ``terms`` in all images as one batch.

    Every direction has a view; one to which the body did not turn has neither image nor sightings, and what the map says is in
    its way.
    """
    count, facing = body.spec.lookaround_count, 0
    taken = {facing: body.view}
    for turn in turns:
        body.step(turn, Phase.LOOKAROUND)
        facing = (facing + (1 if isinstance(turn, TurnLeft) else -1)) % count
        taken[facing] = body.view
    ahead = {(place - facing) % count: observation for place, observation in taken.items()}
    ordered = tuple(ahead[k] for k in sorted(ahead))
    seen = dict(zip(sorted(ahead), world.perceive(ordered, terms), strict=True))
    views = tuple(_view(ahead[k], seen[k], body, world) if k in ahead else _unseen(k, body, world) for k in range(count))
    return Panorama(ordered, views)


def _view(observation: Observation, seen: tuple[Sighting, ...], body: Body, world: World) -> View:
    heading_rad = wrap_angle(observation.pose.yaw_rad - body.pose.yaw_rad)
    return View(
        label=egocentric_label(heading_rad, round(body.spec.turn_deg)),
        heading_rad=heading_rad,
        rgb=observation.rgb,
        obstacle_m=world.clearance_m(observation),
        sightings=seen,
    )


def _unseen(k: int, body: Body, world: World) -> View:
    """The k-th direction to the left, not turned to."""
    heading_rad = wrap_angle(k * math.radians(body.spec.turn_deg))
    return View(
        label=egocentric_label(heading_rad, round(body.spec.turn_deg)),
        heading_rad=heading_rad,
        rgb=None,
        obstacle_m=world.clearance_m(body.view, heading_rad),
    )
