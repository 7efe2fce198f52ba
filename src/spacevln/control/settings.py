"""Every threshold of the control rules in one frozen value."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ControlSettings:
    """Thresholds of the control rules (DESIGN 5.6; paper appendix "Control Reliability").

    Args:
        stage_decisions: executor decisions per stage. [authors' code]
        retries: N_retry, how often a rejected reply is asked again. [ours; the paper names it without a value]
        consecutive_turns: N_turn, turn decisions in a row before only forward or STOP is left. [paper]
        stall_m: a forward primitive that moves less than this has stalled [m]. [authors' code]
        traversable_m: least obstacle distance of a direction that counts as traversable: what is nearer lies under the depth
            sensor's near limit [m]. [authors' code]
        stand_off_m: what a forward leaves between the body's centre and the obstacle in front: body radius 0.10 plus one map
            cell [m]. [ours]
        past_opening_m: how far inside a space it counts as reached [m]. [ours]
        meant_landmark_m: how near a metric target must be for the arrival at the landmark beside it [m]. [ours]
        ahead_deg: how far off the chosen direction a landmark that is in reach from the start may lie to be the one meant,
            where no metric target tells [deg]. [ours]
        target_radius_m: radius around a metric target without a landmark [m]. [authors' code]
        floor_change_m: height difference that counts as another floor [m]. [authors' code]
        stable_boundaries: planning boundaries in a row that make a final arrival stable. [authors' code]
        stable_motion_m: motion between them that is still negligible [m]. [authors' code]
        final_landmark_m: how near the final landmark must be for "inside the final region" when the goal names no space
            [m]. [ours]
    """

    stage_decisions: int = 5
    retries: int = 3
    consecutive_turns: int = 3
    stall_m: float = 0.05
    traversable_m: float = 0.5
    stand_off_m: float = 0.15
    past_opening_m: float = 0.5
    meant_landmark_m: float = 1.5
    ahead_deg: float = 60.0
    target_radius_m: float = 0.35
    floor_change_m: float = 1.5
    stable_boundaries: int = 3
    stable_motion_m: float = 1.0
    final_landmark_m: float = 1.5
