"""Houses for Habitat-Sim: the same geometry to a millimetre, every triangle's instance, and a suite's episodes in their place."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from spacevln.cli.houses import houses
from spacevln.core.geometry import Float
from spacevln.environments.bridge.labels import label_of
from spacevln.environments.houses.export import placed
from spacevln.environments.houses.habitat_export import export_for_habitat, semantic_colour
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.labels import house_labels
from spacevln.environments.houses.scene import scene_pieces
from spacevln.evaluation import datasets

SEED = 9


def test_every_instance_has_a_colour_of_its_own() -> None:
    colours = {semantic_colour(instance) for instance in range(100_000)}
    assert len(colours) == 100_000
    assert semantic_colour(0) == (0, 0, 0)


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("trimesh")
    return export_for_habitat(build_house(SEED), tmp_path_factory.mktemp("scenes"))


def from_gltf(points: Float) -> Float:
    """To the scene frame."""
    return np.column_stack([points[:, 0], -points[:, 2], points[:, 1]])


def corners() -> list[Float]:
    """Corners of every piece's triangles as the embedded simulator draws them."""
    found = []
    for piece in scene_pieces(build_house(SEED)):
        T_scene_piece = placed(piece)
        points = piece.triangles.points @ T_scene_piece[:3, :3].T + T_scene_piece[:3, 3]
        found.append(points[piece.triangles.faces].reshape(-1, 3))
    return found


@pytest.mark.slow
def test_geometry_and_instances_are_those_of_the_house(exported: Path) -> None:
    import trimesh

    scene = trimesh.load(exported)
    wanted = corners()
    loaded: dict[int, Float] = {}
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        at = mesh.vertices[mesh.faces].reshape(-1, 3) @ transform[:3, :3].T + transform[:3, 3]
        loaded[int(node.split()[-1])] = from_gltf(at)
        assert mesh.visual.material.baseColorTexture is not None
    assert len(loaded) == len(wanted)
    assert max(float(np.abs(loaded[k] - each).max()) for k, each in enumerate(wanted)) < 1e-3

    (semantic,) = trimesh.load(exported.with_name(f"{exported.stem}.semantic.glb")).geometry.values()
    assert np.abs(from_gltf(semantic.vertices[semantic.faces].reshape(-1, 3)) - np.concatenate(wanted)).max() < 1e-3
    picture = np.asarray(semantic.visual.material.baseColorTexture)
    rows = ((1 - semantic.visual.uv[semantic.faces[:, 0], 1]) * len(picture)).astype(int)
    pieces = scene_pieces(build_house(SEED))
    instances = np.repeat([piece.instance for piece in pieces], [len(piece.triangles.faces) for piece in pieces])
    np.testing.assert_array_equal(picture[rows, 0], [semantic_colour(int(each)) for each in instances])


@pytest.mark.slow
def test_annotations_and_configurations_say_how_to_read_it(exported: Path) -> None:
    home, folder = exported.parent, exported.parents[2]
    head, *lines = (home / f"{exported.stem}.semantic.txt").read_text().splitlines()
    labels = house_labels(build_house(SEED))
    assert head == "HM3D Semantic Annotations"
    assert len(lines) == len(labels)
    for line in lines:
        number, colour, name, _ = line.split(",")
        assert tuple(bytes.fromhex(colour)) == semantic_colour(int(number))
        assert label_of(name.strip('"')) == labels[int(number)]
    stage = json.loads((home / f"{exported.stem}.stage_config.json").read_text())
    assert all((home / stage[key]).exists() for key in ("render_asset", "semantic_asset", "semantic_descriptor_filename"))
    assert stage["up"] == [0, 1, 0]
    assert (folder / "houses.scene_dataset_config.json").exists()


@pytest.mark.slow
def test_a_suite_is_exported_with_its_houses(tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    words = ["export", "--format", "habitat", "--suite", "houses-vln", "--split", "dev", "--houses", "1", "--out", str(tmp_path)]
    done = CliRunner().invoke(houses, words, standalone_mode=False)
    assert done.exception is None
    episodes = datasets.load("r2r-ce", tmp_path / "houses-vln_dev.json.gz")
    assert all((tmp_path / "scenes" / episode.scene).exists() for episode in episodes)
    written = json.loads(gzip.decompress((tmp_path / "houses-vln_dev.json.gz").read_bytes()))["episodes"]
    assert len(written) == len(episodes) == 1


@pytest.mark.slow
def test_the_glb_files_pass_the_khronos_validator(exported: Path) -> None:
    modules = os.environ.get("SPACEVLN_TEST_GLTF_VALIDATOR", "")
    if not (modules and shutil.which("node")):
        pytest.skip("`npm install gltf-validator`, and name its node_modules in SPACEVLN_TEST_GLTF_VALIDATOR")
    script = (
        "const [modules, ...files] = process.argv.slice(1), validator = require(modules + '/gltf-validator'), fs = require('fs');"
        "Promise.all(files.map(f => validator.validateBytes(new Uint8Array(fs.readFileSync(f)))))"
        ".then(all => console.log(JSON.stringify(all.map(r => r.issues))))"
    )
    files = [str(exported), str(exported.with_name(f"{exported.stem}.semantic.glb"))]
    done = subprocess.run(["node", "-e", script, modules, *files], capture_output=True, text=True, check=True)
    for issues in json.loads(done.stdout):
        assert (issues["numErrors"], issues["numWarnings"]) == (0, 0)
