"""Everything that can be set in a run, in one typed value; its hash identifies the run's configuration."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, NonNegativeFloat, PositiveInt

from spacevln.core import Role, UsageError
from spacevln.memory import SavedMemory, load_memory
from spacevln.models import ModelChoice
from spacevln.reasoning.spatial_cot import Layout, PromptSettings

_PROMPTS = PromptSettings()


class _Settings(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class HousesSettings(_Settings):
    """The embedded houses.

    Args:
        renderer: ``auto`` takes GL where a library is found, else ray casting.
        sliding: slide along obstacles as in VLN-CE, or stop at contact.
    """

    renderer: Literal["auto", "gl", "raycast"] = "auto"
    sliding: bool = True


class _BridgedSettings(_Settings):
    """A simulator in a Python of its own (:class:`~spacevln.environments.bridge.setup.BridgeSetup` says what each means).

    Args:
        preset: which of :data:`~.benchmark_presets.PRESETS` the values come from; the values themselves count.
    """

    preset: str
    python: str
    scenes: str
    width_px: PositiveInt
    height_px: PositiveInt
    hfov_deg: float = Field(gt=0, lt=180)
    camera_height_m: float = Field(gt=0)
    step_m: float = Field(default=0.25, gt=0)
    turn_deg: float = Field(gt=0)
    depth_min_m: float = Field(ge=0)
    depth_max_m: float = Field(gt=0)
    gpu_device: int = Field(default=0, ge=-1)
    seed: int = 0


class HabitatSettings(_BridgedSettings):
    """Habitat-Sim (:class:`~spacevln.environments.habitat.setup.HabitatSetup`).

    Args:
        simulator: tells these settings from those of other worlds.
    """

    simulator: Literal["habitat"] = "habitat"
    scene_dataset: str = ""
    cache: str = ""
    agent_height_m: float = Field(gt=0)
    agent_radius_m: float = Field(gt=0)
    cell_size_m: float = Field(default=0.05, gt=0)
    cell_height_m: float = Field(gt=0)
    max_climb_m: float = Field(gt=0)
    max_slope_deg: float = Field(default=45.0, gt=0, lt=90)
    sliding: bool
    labels: bool = True


class GNBenchSettings(_BridgedSettings):
    """GN-Bench's simulator (:class:`~spacevln.environments.gn_bench.setup.GNBenchSetup`).

    Args:
        simulator: tells these settings from those of other worlds.
    """

    simulator: Literal["gn-bench"] = "gn-bench"


class LabelDetectorSettings(_Settings):
    """Simulated errors of the detector that reads simulator labels.

    Args:
        miss_rate: share of visible instances that it overlooks, per image.
        confusion_rate: share that it calls by the name of a similar category, per image.
        jitter_px: largest shift of a mask at 640 px image width.
        seed: of these errors.
    """

    miss_rate: float = Field(default=0.0, ge=0, le=1)
    confusion_rate: float = Field(default=0.0, ge=0, le=1)
    jitter_px: NonNegativeFloat = 0.0
    seed: int = 0


class OpenVocabularySettings(_Settings):
    """A detector of published models, for worlds without labels.

    Args:
        grounder: that finds boxes, by its name in the catalogue of weights.
        segmenter: that cuts masks; ``none`` = boxes only.
        box_threshold, text_threshold: 0.25 and 0.25 for landmarks, 0.5 and 0.5 for object goals.
        device, dtype: where and how precisely.
        batch_size: images per forward pass.
        shared: one process of this machine holds the models for every worker.
    """

    grounder: str
    segmenter: str
    box_threshold: float = Field(default=0.25, ge=0, le=1)
    text_threshold: float = Field(default=0.25, ge=0, le=1)
    device: Literal["auto", "cpu", "cuda", "mps"] = "auto"
    dtype: Literal["float32", "float16", "bfloat16"] = "float32"
    batch_size: PositiveInt = 12
    shared: bool = False


class ComponentSettings(_Settings):
    """The paper's ablation switches (Table 4, DESIGN 6); off removes the component, not only its text."""

    hsm: bool = True
    landmark_memory: bool = True
    planner_scot: bool = True
    executor_scot: bool = True
    stagewise: bool = True


class KnownBuilding(_Settings):
    """The memory of earlier episodes in the building, told beside every result that used it: such a run is not zero-shot.

    Args:
        path: of the file that an episode's record left, ``memory.npz``.
        digest: first 16 hex digits of its SHA-256; what was loaded is this very file.
    """

    path: str
    digest: str

    @classmethod
    def of(cls, path: Path) -> KnownBuilding:
        """The setting for a file.

        Raises:
            UsageError: it cannot be read.
        """
        return cls(path=str(path), digest=_digest(path))

    def load(self) -> SavedMemory:
        """The memory itself, anew at every call: an episode grows it in place.

        Raises:
            UsageError: the file is missing, damaged, of another version, or not the one that was set.
        """
        path = Path(self.path)
        if (found := _digest(path)) != self.digest:
            raise UsageError(f"The memory {self.path!r} has changed: its digest was {self.digest} and is {found}; set it anew.")
        return load_memory(path)


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    except OSError as error:
        raise UsageError(
            f"The memory {str(path)!r} cannot be read ({error.strerror}): give the memory.npz of an episode's record."
        ) from error


class ModelPair(_Settings):
    """Which chat models planner and executor ask; they may be the same."""

    planner: ModelChoice
    executor: ModelChoice

    @property
    def choices(self) -> dict[Role, ModelChoice]:
        """By role."""
        return {Role.PLANNER: self.planner, Role.EXECUTOR: self.executor}


class PromptOptions(_Settings):
    """What a model is shown, and how (:class:`~spacevln.reasoning.spatial_cot.PromptSettings`).

    Args:
        view_count: views of the look-around that are shown, evenly spaced from the front.
        layout: separate pictures, or one mosaic.
        view_width_px, forward_width_px, jpeg_quality: of the pictures.
        show_detections: whether views show what was detected of the last stage's landmark.
        turn_steps: largest turn that an executor may choose, in turn primitives.
        planner_max_tokens, executor_max_tokens: bounds of the replies.
    """

    view_count: PositiveInt = _PROMPTS.view_count
    layout: Layout = _PROMPTS.layout
    view_width_px: int = Field(default=_PROMPTS.view_width_px, ge=64, le=4096)
    forward_width_px: int = Field(default=_PROMPTS.forward_width_px, ge=64, le=4096)
    jpeg_quality: int = Field(default=_PROMPTS.jpeg_quality, ge=1, le=100)
    show_detections: bool = _PROMPTS.show_detections
    turn_steps: int = Field(default=_PROMPTS.turn_steps, ge=1, le=6)
    planner_max_tokens: PositiveInt = _PROMPTS.planner_max_tokens
    executor_max_tokens: PositiveInt = _PROMPTS.executor_max_tokens


class Configuration(_Settings):
    """Configuration of a run.

    Args:
        driver: ``agent``, or a baseline: ``random``, ``forward``, ``frontier``, ``oracle`` (the shortest path, by ground truth),
            ``reference`` (a dataset's own path).
        environment: where it drives.
        detector: what grounds landmarks.
        components: which parts of the agent are on.
        planner, executor: who reasons: rules, or a vision-language model.
        models: which models; None where nobody needs one.
        prompts: what they are shown.
        memory: what is known of the building beforehand; None, as in every benchmark, for nothing.
        step_budget: environment steps per episode, STOP included; None takes the task's (260 instructions, 280 object goals).
        arrival_sightings: temporal verification: how many different pictures must show a landmark before it counts as reached;
            1, the paper's rule, believes the first.
        glimpses: searching for an object, the rule planner, which sees nothing but detections, is told what of its look-around's
            terms the images on the way show; False leaves it to its look-arounds. Models see images themselves.
        short_looks: with glimpses, a look-around after the first turns only to where the map knows no floor yet, and to nowhere
            while the goal is in view; False turns once around at every planning boundary, as the paper does.
    """

    driver: Literal["agent", "random", "forward", "frontier", "oracle", "reference"] = "agent"
    environment: HousesSettings | HabitatSettings | GNBenchSettings = HousesSettings()
    detector: LabelDetectorSettings | OpenVocabularySettings = LabelDetectorSettings()
    components: ComponentSettings = ComponentSettings()
    planner: Literal["rules", "vlm"] = "rules"
    executor: Literal["rules", "vlm"] = "rules"
    models: ModelPair | None = None
    prompts: PromptOptions = PromptOptions()
    memory: KnownBuilding | None = None
    step_budget: PositiveInt | None = None
    arrival_sightings: PositiveInt = 1
    glimpses: bool = True
    short_looks: bool = True

    @property
    def hash(self) -> str:
        """First 16 hex digits of the SHA-256 of the canonical JSON."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()[:16]
