"""Where the buildings of a benchmark lie, and what to do when one is missing: licence and download."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from spacevln.core import PrerequisiteError


@dataclass(frozen=True, slots=True)
class SceneFamily:
    """A collection of scanned buildings.

    Args:
        name: of the collection.
        licence: under which it is handed out.
        download: how to get it.
    """

    name: str
    licence: str
    download: str


MP3D = SceneFamily(
    "Matterport3D",
    "Matterport3D Terms of Use (sign the form at https://niessner.github.io/Matterport)",
    "`python2 download_mp.py --task habitat -o DIR`, then unzip so that DIR/mp3d/<id>/<id>.glb exists",
)
HM3D = SceneFamily(
    "HM3D v0.2",
    "Matterport end user licence for academic use",
    "`python -m habitat_sim.utils.datasets_download --username ID --password SECRET --uids hm3d_val_v0.2 --data-path data`",
)
INTERIOR_GS = SceneFamily(
    "InteriorGS",
    "InteriorGS terms of use (gated; accept them on its page)",
    "`huggingface-cli download spatialverse/InteriorGS --repo-type dataset --local-dir DIR`",
)
FAMILIES = {"r2r-ce": MP3D, "rxr-ce": MP3D, "hm3d-ovon": HM3D, "gn-bench": INTERIOR_GS}


def scene_name(scene_id: str) -> str:
    """A scene's path relative to the folder of all scenes, as datasets write it with and without that folder."""
    return scene_id.removeprefix("./").removeprefix("data/scene_datasets/")


def short_names(scene: str) -> frozenset[str]:
    """Every name that a person may use for a scene: ``"mp3d/X/X.glb"`` is also ``"X"``."""
    path = PurePosixPath(scene)
    parts = {part.partition(".")[0] for part in path.parts[-2:]}
    return frozenset({scene, path.name, *parts})


def scene_path(suite: str, scenes_dir: Path, scene: str) -> Path:
    """The file, or for Gaussian splats the folder, of a scene.

    Raises:
        PrerequisiteError: it is not there; the message says licence and download.
    """
    path = scenes_dir / scene
    if not path.exists():
        family = FAMILIES[suite]
        raise PrerequisiteError(
            f"Scene {scene!r} is not in {str(scenes_dir)!r}: it belongs to {family.name} ({family.licence}); "
            f"get it with {family.download}."
        )
    return path
