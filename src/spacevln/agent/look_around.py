"""LookAround(): the 12-view panorama O^12_k (Algorithm 1 line 3; 8 views on a robot)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from spacevln.agent.body import Body, Phase
from spacevln.agent.world import World
from spacevln.core import Observation, Sighting, TurnLeft, View, egocentric_label, wrap_angle


@dataclass(frozen=True, slots=True, eq=False)
class Panorama:
    """One look-around: posed images counter-clockwise from the front, and the views made of them."""

    observations: tuple[Observation, ...]
    views: tuple[View, ...]

    @property
    def sightings(self) -> tuple[Sighting, ...]:
        """Sightings of all views."""
        return tuple(sighting for view in self.views for sighting in view.sightings)

    def heading_rad(self, label: str) -> float:
        """Egocentric heading alpha_i of the view with this label."""
        return next(view.heading_rad for view in self.views if view.label == label)


def look_around(body: Body, world: World, terms: Sequence[str]) -> Panorama:
    """Turn once around, to the left and back to the heading, and detect ``terms`` in all images as one batch."""
    turn = TurnLeft(body.spec.turn_deg)
    observations: list[Observation] = []
    for _ in range(body.spec.lookaround_count):
        body.step(turn, Phase.LOOKAROUND)
        observations.append(body.view)
    ordered = (observations[-1], *observations[:-1])  # the last turn ends at the front
    sightings = world.perceive(ordered, terms)
    views = tuple(_view(observation, seen, body, world) for observation, seen in zip(ordered, sightings, strict=True))
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
