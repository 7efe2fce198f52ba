"""What the agent looks about for while it searches an object, and how far it turns for that at a planning boundary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from spacevln.agent.body import Body
from spacevln.control import turns_to_see, whole_turn
from spacevln.core import Action, Feedback, Sighting, SpatialMap
from spacevln.mapping import unknown_bearings
from spacevln.perception import Match, match


@dataclass(frozen=True, slots=True)
class Watch:
    """An object goal, looked about for on the way; the default is for an instruction, whose landmarks tell the way.

    Args:
        terms: for the detector, in every image of a stage; none leaves the images to the stage's landmark.
        goal: name of the goal object.
        short_looks: see :class:`~spacevln.agent.settings.AgentSettings`.
    """

    terms: tuple[str, ...] = ()
    goal: str = ""
    short_looks: bool = False

    def turns(self, body: Body, space: SpatialMap, feedback: Feedback | None) -> tuple[Action, ...]:
        """The turns of the next look-around.

        Args:
            body: that will turn.
            space: what is known around it.
            feedback: of the last stage; None before the first, where nothing is known. After a stage that did nothing the turn is
                whole: each round of the loop takes steps.
        """
        if feedback is None or not feedback.record.decisions or not self.short_looks:
            return whole_turn(body.spec)
        if feedback.glimpses and self._shows_goal(feedback.glimpses[-1].sightings):
            return ()
        return turns_to_see(unknown_bearings(space, body.pose), body.spec)

    def _shows_goal(self, sightings: Sequence[Sighting]) -> bool:
        return any(match(self.goal, seen.category, seen.attributes) is Match.NAME for seen in sightings)
