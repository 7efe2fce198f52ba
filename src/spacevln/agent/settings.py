"""What can be set about an agent: its components and its control thresholds."""

from __future__ import annotations

from dataclasses import dataclass, field

from spacevln.control import ControlSettings


@dataclass(frozen=True, slots=True)
class Components:
    """The paper's ablation switches (Table 4, DESIGN 6); off removes the component, not only its text.

    Args:
        hsm: Hierarchical Spatial Memory; off: no waypoint text, chain or rendered map.
        landmark_memory: Local Landmark Memory; off: no landmark pool, and a stage's arrival is the executor's own STOP.
        planner_scot, executor_scot: Spatial-CoT fields of the replies; read by the planner and executor, not by the loop.
        stagewise: stage verification and feedback; off: the planner names the next goal, the executor runs until its budget.
    """

    hsm: bool = True
    landmark_memory: bool = True
    planner_scot: bool = True
    executor_scot: bool = True
    stagewise: bool = True


@dataclass(frozen=True, slots=True)
class AgentSettings:
    """Settings of a :class:`~spacevln.agent.loop.NavigationAgent`.

    Args:
        components: which parts are switched on.
        control: thresholds of the control rules.
        step_limit: environment steps of an episode, STOP included; None takes the task's own (260 or 280, paper).
        glimpses: of object goals, in every image of a stage the detector is asked for all that the planner's look-around asks
            for, and the planner is told: what a model sees in the executor's images, for planners that see but detections.
        short_looks: of object goals, a look-around after the first turns only to where the map knows no floor yet, and to
            nowhere while the goal is in view. It needs glimpses, and what the planner keeps: with Hierarchical Spatial Memory or
            stagewise control off, look-arounds are whole.
        arrival_sightings: temporal verification, see :class:`~spacevln.memory.LocalLandmarkMemory`; 1 is the paper's rule.
    """

    components: Components = field(default_factory=Components)
    control: ControlSettings = field(default_factory=ControlSettings)
    step_limit: int | None = None
    glimpses: bool = False
    short_looks: bool = False
    arrival_sightings: int = 1
