"""The words of the rule planner's Spatial-CoT, from the same evidence that its decisions use."""

from __future__ import annotations

import math

from spacevln.core import Anchor, PlannerContext, SpaceKind, egocentric_label
from spacevln.language import cue_kind, head_noun, region_kind
from spacevln.language.nouns_lexicon import OPENINGS
from spacevln.reasoning.rules.world import World


def describe_here(context: PlannerContext, world: World) -> Anchor:
    """The present place: inferred region type and the nearest thing."""
    pose = context.pose
    room = world.room_at(world.floor, (pose.x_m, pose.y_m), 1.0)
    region = world.region(world.floor, room) if room else ""
    things = [(math.hypot(t.xy[0] - pose.x_m, t.xy[1] - pose.y_m), t) for t in world.things_of(world.floor, room)] if room else []
    nearest = min(things, key=lambda item: (item[0], item[1].id), default=None)
    cue = nearest[1].category if nearest is not None and nearest[0] < 4.0 else ""
    if not region and not cue:
        return Anchor("open floor", SpaceKind.UNKNOWN)
    return Anchor(region, region_kind(region) if region else SpaceKind.UNKNOWN, cue, cue_kind(cue))


def observation_text(context: PlannerContext, most: int = 8) -> str:
    """What is seen, nearest first, with directions."""
    seen: dict[tuple[str, str], float] = {}
    for view in context.views:
        for sighting in view.sightings:
            key = (
                " ".join((*sighting.attributes[:1], head_noun(sighting.category))),
                egocentric_label(context.pose.bearing_rad(*sighting.position_m[:2])),
            )
            seen[key] = min(seen.get(key, math.inf), sighting.distance_m)
    if not seen:
        return "Nothing that has a name is seen."
    ordered = sorted(seen.items(), key=lambda item: (item[1], item[0]))
    ways = sum(1 for (name, _), _ in ordered if name.split()[-1] in OPENINGS)
    listed = "; ".join(f"{name} {direction} {distance:.1f} m" for (name, direction), distance in ordered[:most])
    return f"{listed}. {ways} ways out in view."


def progress_text(chain: tuple[Anchor, ...], index: int, reached: bool) -> str:
    """The anchor chain with marks."""
    marks = (f"{'done' if i < index else 'here' if i == index else 'to do'}: {anchor}" for i, anchor in enumerate(chain))
    return ("The last stage reached its target. " if reached else "") + " > ".join(marks)
