"""Pages of a long run (goals: 1,800 episodes open in 2 s, under 5 MB; 100 episode pages in 60 s, each under 15 MB)."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from spacevln.assembly import Configuration, HousesSettings
from spacevln.cli.output import describe_run
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.houses import pick_episode
from spacevln.evaluation.runner import claim_directory
from spacevln.evaluation.summary import summarise
from spacevln.recording import RecordLevel, episode_directory, read_result, write_file
from spacevln.viewer import write_site

EPISODES = 1800
MB = 1_000_000
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run of one episode, recorded whole and filmed from behind."""
    directory = tmp_path_factory.mktemp("run")
    configuration = Configuration(environment=HousesSettings())
    claim_directory(directory, describe_run("houses-vln", configuration))
    episode = pick_episode("vln", 9)
    folder = episode_directory(directory, episode.episode_id)
    with Session(configuration) as session:
        write_file(directory / "summary.json", summarise([session.attempt(episode, folder, level=RecordLevel.FULL, chase=True)]))
    return directory


@pytest.fixture(scope="module")
def long_run(run, tmp_path_factory):
    """The same episode 1,800 times under other names, with the last picture of each."""
    directory = tmp_path_factory.mktemp("long")
    folder = next((run / "episodes").iterdir())
    result = read_result(folder)
    picture = max((folder / "images").glob("*_rgb.jpg"))
    shutil.copy(run / "run.json", directory)
    results = [result.model_copy(update={"episode_id": f"houses-vln-{number:06d}"}) for number in range(EPISODES)]
    write_file(directory / "summary.json", summarise(results))
    for each in results:
        copy = episode_directory(directory, each.episode_id)
        (copy / "images").mkdir(parents=True)
        (copy / "images" / picture.name).symlink_to(picture)
        (copy / "result.json").write_text(each.model_dump_json(), encoding="utf-8")
    return write_site(directory)


@pytest.mark.benchmark(group="pages")
def test_an_episode_page_is_built(benchmark, run):
    folder = next((run / "episodes").iterdir())
    page = benchmark.pedantic(lambda: write_site(folder), rounds=5, warmup_rounds=1)
    shown = [path for pattern in ("*_rgb.jpg", "*_external.jpg", "stage_*.png") for path in (folder / "images").glob(pattern)]
    size = page.stat().st_size + sum(path.stat().st_size for path in shown)
    benchmark.extra_info["MB"] = {"page": page.stat().st_size / MB, "with its pictures": size / MB}
    assert size < 15 * MB
    assert 100 * benchmark.stats["median"] < 60


@pytest.mark.benchmark(group="pages")
@pytest.mark.enable_socket
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed: no page is opened")
def test_a_run_page_of_1800_episodes_opens(benchmark, long_run: Path):
    sync_api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed: no page is opened")
    benchmark.extra_info["MB"] = long_run.stat().st_size / MB
    assert long_run.stat().st_size < 5 * MB
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])

        def window():
            return (browser.new_page(viewport={"width": 1280, "height": 900}),), {}

        def opened(page) -> None:
            page.goto(long_run.as_uri(), wait_until="load")
            page.locator("#find").fill("001799")
            assert page.locator("#shown").inner_text() == "1 shown"

        benchmark.pedantic(opened, setup=window, rounds=5, warmup_rounds=1)
        browser.close()
    assert benchmark.stats["median"] < 2
