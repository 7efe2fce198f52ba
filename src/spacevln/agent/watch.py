"""What the agent looks about for while it searches an object, and how far it turns for that at a planning boundary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from spacevln.agent.body import Body
from spacevln.control import turns_to_see, whole_turn
from spacevln.core import Action, Feedback, Pose, Sighting, SpatialMap, StageEnd
from spacevln.mapping import unknown_bearings
from spacevln.perception import Match, match

LED_ON_M = 0.5  # a stage that ends nearer to where it began led nowhere


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
            feedback: of the last stage; None before the first, where nothing is known. After a stage that led nowhere the turn
                is whole: what was known did not help, and each round of the loop must take steps.
        """
        if feedback is None or not self.short_looks or not feedback.record.decisions:
            return whole_turn(body.spec)
        in_view = self._shows_goal(feedback.glimpses[-1].sightings)
        if not _led_on(feedback, body.pose) and not (in_view and not feedback.subtask.targets_final_anchor):
            return whole_turn(body.spec)
        return () if in_view else turns_to_see(unknown_bearings(space, body.pose), body.spec)

    def _shows_goal(self, sightings: Sequence[Sighting]) -> bool:
        return any(match(self.goal, seen.category, seen.attributes) is Match.NAME for seen in sightings)


def _led_on(feedback: Feedback, pose: Pose) -> bool:
    """Whether a stage took the body to another place, and the executor did not give it up."""
    given_up = feedback.end in (StageEnd.STOP, StageEnd.BLOCKED)
    return not given_up and feedback.record.start.distance_m(pose.x_m, pose.y_m) >= LED_ON_M
