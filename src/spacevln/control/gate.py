"""The episode gate: may STOP be issued? (appendix "Stage and Episode Termination Criteria")."""

from __future__ import annotations

from dataclasses import dataclass

from spacevln.control.anchors import same_space
from spacevln.core import Anchor, CueKind, LandmarkPool, SpaceKind


@dataclass(frozen=True, slots=True)
class FinishClaim:
    """What speaks for a finish at a planning boundary.

    Args:
        chain: C_k.
        located_index: index of the anchor that the agent is matched to.
        verified_before: index of the furthest anchor that was verified before this boundary; -1 for none.
        place: space of the present place, ``""`` when unknown.
        pool: landmark pool of the final anchor's cue, as seen now.
        arrived: the last stage headed for the final anchor and ended by arrival.
        changed_floor: another floor was reached since the last flight of the chain that is verified, or since the start.
    """

    chain: tuple[Anchor, ...]
    located_index: int
    verified_before: int
    place: str
    pool: LandmarkPool
    arrived: bool
    changed_floor: bool


@dataclass(frozen=True, slots=True)
class GateVerdict:
    """Judgement of a claim: the clauses that applied, with their outcome, in a fixed order."""

    clauses: tuple[tuple[str, bool], ...]

    @property
    def accepted(self) -> bool:
        """Every clause that applied holds."""
        return all(holds for _, holds in self.clauses)

    @property
    def reason(self) -> str:
        """One sentence for the model."""
        failed = [name.replace("_", " ") for name, holds in self.clauses if not holds]
        return (
            f"finish refused: no evidence for {', '.join(failed)}. Give the stage that leads to it."
            if failed
            else "finish accepted."
        )


@dataclass(frozen=True, slots=True)
class EpisodeGate:
    """Judges finishes. A clause binds only while the component that supplies its evidence is switched on (DESIGN 5.6).

    - ``final_anchor_claimed``: the planner matches the agent to the last anchor. Always binds.
    - ``earlier_anchors_verified`` (stagewise verification): all anchors but the last two were verified at earlier
      boundaries. The present boundary may verify the target of the last stage, and the goal beside it.
    - ``final_space_localised`` (Hierarchical Spatial Memory), where the final anchor names a space: the present place does
      not contradict it; where that anchor has no cue, it must agree, or the last stage must have arrived there.
    - ``change_of_floor``, where the final anchor is a flight to be taken: the floor has changed. Whoever stands beside stairs, or
      half-way up, has not taken them.
    - ``landmark_arrival`` (Local Landmark Memory), of any other final anchor with a cue: a candidate of it is within its
      arrival radius, or the last stage arrived at it.

    Args:
        hsm, landmark_memory, stagewise: which components are switched on.
    """

    hsm: bool = True
    landmark_memory: bool = True
    stagewise: bool = True

    def judge(self, claim: FinishClaim) -> GateVerdict:
        """Every clause that applies to the claim, with its outcome."""
        last = len(claim.chain) - 1
        final = claim.chain[last]
        clauses = [("final_anchor_claimed", claim.located_index == last)]
        if self.stagewise:
            clauses.append(("earlier_anchors_verified", claim.verified_before >= last - 2))
        if final.space_kind is SpaceKind.FLOOR_TRANSITION:
            return GateVerdict((*clauses, ("change_of_floor", claim.changed_floor)))
        if self.hsm and final.space:
            clauses.append(("final_space_localised", self._localised(final, claim)))
        if self.landmark_memory and final.cue:
            arrived = claim.arrived or any(candidate.arrived for candidate in claim.pool)
            clauses.append(("landmark_arrival", arrived))
        return GateVerdict(tuple(clauses))

    @staticmethod
    def _localised(final: Anchor, claim: FinishClaim) -> bool:
        if same_space(claim.place, final.space):
            return True
        if not final.cue:
            return claim.arrived
        return not claim.place or final.cue_kind is CueKind.OPENING  # an opening belongs to the spaces on both of its sides
