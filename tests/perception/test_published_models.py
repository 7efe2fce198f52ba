"""The real loading, pre- and post-processing of every model, on tiny random checkpoints. Needs the extra ``perception``."""

import hashlib
import os
import pickle
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from published_layout import layout
from scenes import observe

torch = pytest.importorskip("torch", reason="needs the extra 'perception'; .ci/run installs it and runs this")
pytest.importorskip("transformers", reason="needs the extra 'perception'; .ci/run installs it and runs this")
os.environ.setdefault("HF_HUB_OFFLINE", "1")

import tiny_models  # noqa: E402

from spacevln.core import Detector, Observation, UsageError  # noqa: E402
from spacevln.perception.open_vocabulary.boxes import BoxRules  # noqa: E402
from spacevln.perception.open_vocabulary.checkpoints import load_tensors  # noqa: E402
from spacevln.perception.open_vocabulary.compute import Compute  # noqa: E402
from spacevln.perception.open_vocabulary.detector import Grounder, OpenVocabularyDetector  # noqa: E402
from spacevln.perception.open_vocabulary.grounding_dino import GroundingDino  # noqa: E402
from spacevln.perception.open_vocabulary.owlv2 import Owlv2  # noqa: E402
from spacevln.perception.open_vocabulary.promptable import PromptableSegmenter  # noqa: E402
from spacevln.perception.open_vocabulary.queries import queries_of  # noqa: E402
from spacevln.perception.open_vocabulary.repvit import EncoderShape  # noqa: E402
from spacevln.perception.open_vocabulary.repvit_sam import (  # noqa: E402
    RepViTSam,
    RepViTSamShape,
    load_repvit_sam,
    open_repvit_sam,
    renamed,
)
from spacevln.perception.open_vocabulary.sam import open_sam  # noqa: E402
from spacevln.testing.detector import DetectorConformance  # noqa: E402

CPU = Compute("cpu")
PHRASES = ("white sofa", "couch", "doorway")
SMALL = RepViTSamShape(EncoderShape((8, 16, 32, 64), (3, 3, 3, 2), out_width=16), image_px=64, mlp_width=16)
LAYOUT_DIGEST = "b083b07b91111f5b21041cdfc36626b410aeaa19e3dfa7415ff42b98dd1b7b4d"
"""SHA-256 over the sorted names and shapes of the published file."""

GROUNDERS = ("grounding-dino", "mm-grounding-dino", "owlv2")
SEGMENTERS = ("sam", "sam2", "repvit-sam")


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    root = tmp_path_factory.mktemp("models")
    torch.manual_seed(0)
    torch.save(published(RepViTSam(SMALL)), root / "repvit_sam.pt")
    return {
        "grounding-dino": tiny_models.grounding_dino(root / "gdino"),
        "mm-grounding-dino": tiny_models.grounding_dino(root / "mm", mm=True),
        "owlv2": tiny_models.owlv2(root / "owlv2"),
        "sam": tiny_models.sam(root / "sam"),
        "sam2": tiny_models.sam2(root / "sam2"),
        "repvit-sam": root / "repvit_sam.pt",
    }


def published(model: RepViTSam) -> dict[str, "torch.Tensor"]:
    """A model's tensors under the names of the published layout, as far as its depth goes."""
    ours = model.state_dict()
    names = {renamed(name): name for name in layout()}
    return {names.get(name, name): tensor for name, tensor in ours.items()}


def pictures(count: int, width: int = 96, height: int = 72) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    return [rng.integers(0, 255, (height, width, 3), np.uint8) for _ in range(count)]


def grounder(folders: dict[str, Path], name: str) -> Grounder:
    return Owlv2(folders[name], CPU) if name == "owlv2" else GroundingDino(folders[name], CPU)


def segmenter(folders: dict[str, Path], name: str) -> PromptableSegmenter:
    return open_repvit_sam(folders[name], CPU, SMALL) if name == "repvit-sam" else open_sam(folders[name], CPU)


@pytest.mark.parametrize("name", GROUNDERS)
def test_a_batch_scores_as_single_images_and_phrases_are_asked_exactly(folders: dict[str, Path], name: str) -> None:
    model, images, queries = grounder(folders, name), pictures(3), queries_of(PHRASES)
    together = model.ground(images, queries, 0.0)
    for image, found in zip(images, together, strict=True):
        (alone,) = model.ground([image], queries, 0.0)
        assert found.boxes_px.shape == (len(found.scores), 4)
        assert found.scores.shape[1] == len(PHRASES)
        assert len(found.scores) > 0
        np.testing.assert_allclose(found.scores, alone.scores, atol=1e-5)
        np.testing.assert_allclose(found.boxes_px, alone.boxes_px, atol=1e-5 * 96)


@pytest.mark.parametrize("mm", [False, True])
def test_boxes_and_token_scores_are_those_of_the_library_s_own_post_processing(folders: dict[str, Path], mm: bool) -> None:
    from transformers import GroundingDinoProcessor

    model, (image,) = grounder(folders, "mm-grounding-dino" if mm else "grounding-dino"), pictures(1)
    assert isinstance(model, GroundingDino)
    processor = GroundingDinoProcessor(model._processor, model._tokenizer)
    inputs = processor(images=image, text="white sofa . couch . doorway .", return_tensors="pt")
    with torch.inference_mode():
        outputs = model._model(**inputs)
    theirs = processor.post_process_grounded_object_detection(
        outputs, inputs["input_ids"], threshold=0.05, text_threshold=0.0, target_sizes=[image.shape[:2]]
    )[0]
    (ours,) = model.ground([image], queries_of(PHRASES), 0.0)
    np.testing.assert_allclose(ours.boxes_px, theirs["boxes"].numpy(), atol=1e-3)
    assert (ours.scores.max(axis=1) <= theirs["scores"].numpy() + 1e-6).all()


def test_many_phrases_are_asked_in_several_captions(folders: dict[str, Path]) -> None:
    model = grounder(folders, "grounding-dino")
    assert isinstance(model, GroundingDino)
    model._max_tokens = 12
    queries = queries_of(["white sofa", "black sofa", "couch", "doorway", "table"])
    (split,) = model.ground(pictures(1), queries, 0.0)
    assert split.scores.shape[1] == 5
    assert (split.scores.max(axis=0) > 0).all()
    (first,) = model.ground(pictures(1), queries[:2], 0.0)
    np.testing.assert_allclose(split.scores[: len(first.scores), :2], first.scores, atol=1e-6)


@pytest.mark.parametrize("name", SEGMENTERS)
def test_masks_have_their_boxes_sizes_and_do_not_depend_on_the_other_boxes(folders: dict[str, Path], name: str) -> None:
    model, (image,) = segmenter(folders, name), pictures(1)
    boxes = [(5, 8, 40, 60), (50, 0, 96, 72), (20, 20, 24, 23)]
    masks = model.segment(image, boxes)
    assert [mask.shape for mask in masks] == [(52, 35), (72, 46), (3, 4)]
    for mask, box in zip(masks, boxes, strict=True):
        (alone,) = model.segment(image, [box])
        assert (mask == alone).mean() > 0.99


@pytest.mark.parametrize("name", ["sam", "sam2"])
def test_masks_are_those_of_the_library_s_own_post_processing(folders: dict[str, Path], name: str) -> None:
    import torch.nn.functional as functional

    segment, (image,) = segmenter(folders, name), pictures(1)
    box = (5, 8, 60, 70)
    (ours,) = segment.segment(image, [box])
    height, width = image.shape[:2]
    framing = segment.framing(width, height, segment.size_px)
    from spacevln.perception.open_vocabulary.promptable import prepared

    with torch.inference_mode():
        logits, quality = segment.model.decode(
            segment.model.embed(torch.from_numpy(prepared(image, framing))), torch.from_numpy(framing.to_input([box]))[None]
        )
        size = (round(height * framing.scale_y), round(width * framing.scale_x))
        whole = functional.interpolate(logits, (segment.size_px, segment.size_px), mode="bilinear", align_corners=False)
        whole = functional.interpolate(whole[..., : size[0], : size[1]], (height, width), mode="bilinear", align_corners=False)
    theirs = (whole[0, int(quality[0].argmax())] > 0).numpy()[8:70, 5:60]
    assert (ours == theirs).mean() > 0.97


def test_the_published_layout_is_the_described_one_and_ours() -> None:
    listing = "\n".join(f"{name} {list(shape)}" for name, shape in sorted(layout().items()))
    assert hashlib.sha256(listing.encode()).hexdigest() == LAYOUT_DIGEST
    with torch.device("meta"):
        ours = {name: tuple(tensor.shape) for name, tensor in RepViTSam().state_dict().items()}
    assert {renamed(name): shape for name, shape in layout().items()} == ours


def test_a_made_up_file_of_the_published_layout_loads(tmp_path: Path) -> None:
    rng = torch.Generator().manual_seed(0)
    table = {
        name: torch.zeros((), dtype=torch.int64)
        if name.endswith("num_batches_tracked")
        else torch.rand(shape, generator=rng) * 0.1
        for name, shape in layout().items()
    }
    torch.save(table, tmp_path / "repvit_sam.pt")
    model = load_repvit_sam(tmp_path / "repvit_sam.pt")
    gaussian = table["prompt_encoder.pe_layer.positional_encoding_gaussian_matrix"]
    assert torch.equal(model.prompt_encoder.shared_embedding.positional_embedding, gaussian)
    assert torch.equal(
        model.image_encoder.features[53].token_mixer[1].fc1.weight, table["image_encoder.features.53.token_mixer.1.fc1.weight"]
    )
    hidden = "mask_decoder.iou_prediction_head.layers."
    assert torch.equal(model.mask_decoder.iou_prediction_head.proj_in.weight, table[f"{hidden}0.weight"])
    assert torch.equal(model.mask_decoder.iou_prediction_head.layers[0].weight, table[f"{hidden}1.weight"])
    with torch.inference_mode():
        assert model.eval().embed(torch.zeros(1, 3, 128, 128)).shape == (1, 256, 8, 8)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("missing", "neck.0.weight is missing"),
        ("unknown", "extra is unknown"),
        ("shape", "instead of"),
        ("nested", "no flat table"),
        ("truncated", "damaged|cannot be read"),
        ("noise", "damaged|cannot be read"),
        ("empty", "damaged|cannot be read"),
        ("absent", "does not exist"),
    ],
)
def test_damaged_or_other_checkpoints_are_refused_in_a_sentence(
    folders: dict[str, Path], tmp_path: Path, change: str, said: str
) -> None:
    path, whole = tmp_path / "repvit_sam.pt", folders["repvit-sam"].read_bytes()
    table = torch.load(folders["repvit-sam"], weights_only=True)
    if change in ("missing", "unknown", "shape", "nested"):
        if change == "missing":
            del table["image_encoder.neck.0.weight"]
        if change == "unknown":
            table["extra"] = torch.zeros(1)
        if change == "shape":
            table["image_encoder.neck.0.weight"] = torch.zeros(3)
        torch.save({"model": table} if change == "nested" else table, path)
    elif change != "absent":
        path.write_bytes({"truncated": whole[: len(whole) // 2], "noise": b"\x93" * 4096, "empty": b""}[change])
    with pytest.raises(UsageError, match=said):
        load_repvit_sam(path, SMALL)


class Malicious:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.mkdir, (os.environ["PLANTED"],)


@pytest.mark.parametrize("form", ["zip", "pickle"])
def test_a_checkpoint_that_runs_code_is_refused_before_it_can(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    monkeypatch.setenv("PLANTED", str(tmp_path / "planted"))
    path = tmp_path / "weights.pt"
    if form == "zip":
        torch.save({"weight": Malicious()}, path)
    else:
        path.write_bytes(pickle.dumps({"weight": Malicious()}, protocol=2))
    with pytest.raises(UsageError, match="is refused"):
        load_tensors(path)
    assert not (tmp_path / "planted").exists()


@pytest.mark.parametrize("name", [*GROUNDERS, "sam", "sam2"])
def test_folders_are_read_from_safetensors_only(folders: dict[str, Path], tmp_path: Path, name: str) -> None:
    for file in folders[name].iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    weights = tmp_path / "model.safetensors"
    open_it = (lambda: grounder({name: tmp_path}, name)) if name in GROUNDERS else (lambda: segmenter({name: tmp_path}, name))
    weights.write_bytes(weights.read_bytes()[:1000])
    with pytest.raises(UsageError, match="cannot be opened"):
        open_it()
    weights.unlink()
    (tmp_path / "pytorch_model.bin").write_bytes(pickle.dumps(Malicious))
    with pytest.raises(UsageError, match="cannot be opened"):
        open_it()


@pytest.fixture(scope="module")
def parts(folders: dict[str, Path]) -> tuple[Grounder, PromptableSegmenter]:
    return grounder(folders, "grounding-dino"), segmenter(folders, "repvit-sam")


class TestWholeDetector(DetectorConformance):
    """GroundingDINO and RepViT-SAM together, with thresholds that random weights reach."""

    @pytest.fixture(autouse=True)
    def _opened(self, parts: tuple[Grounder, PromptableSegmenter]) -> None:
        self.parts = parts

    def make_detector(self) -> Detector:
        return OpenVocabularyDetector(*self.parts, BoxRules(0.05, 0.0), batch_size=2)

    def make_scene(self) -> tuple[Sequence[Observation], str]:
        scenes = [observe({1: ("sofa", (), (20, 40, 60, 80, 2.0))}) for _ in range(2)]
        for scene, picture in zip(scenes, pictures(2, 160, 120), strict=True):
            scene.rgb[:] = picture
        return scenes, "white sofa"
