"""The pages in a real browser, opened from disk. Skipped where there is no Chromium or no Playwright."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from small_records import PAYLOAD, write_episode, write_run

from spacevln.viewer import write_comparison, write_site
from spacevln.viewer.pages import site

sync_api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed: no page is opened")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed: no page is opened"),
    pytest.mark.enable_socket,  # Playwright talks to its own child over a loopback socket
]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = write_run(tmp_path_factory.mktemp("run"), 4, "Go on." + PAYLOAD)
    write_site(directory)
    write_comparison(directory / "episodes/e-000", directory / "episodes/e-001", directory / "compare")
    return directory


class Tab:
    """A page that remembers what went wrong in it."""

    def __init__(self, browser: Any, path: Path, fragment: str = "", *, width: int = 1280, scheme: str = "light") -> None:
        self.context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
        self.page = self.context.new_page()
        self.problems: list[str] = []
        self.page.on("console", self._heard)
        self.page.on("pageerror", lambda error: self.problems.append(str(error)))
        self.page.on("requestfailed", lambda request: self.problems.append(request.url[:200]))
        self.page.goto(path.as_uri() + fragment)

    def _heard(self, message: Any) -> None:
        if message.type in ("error", "warning"):
            self.problems.append(message.text)

    def __enter__(self) -> Any:
        return self.page

    def __exit__(self, *_: object) -> None:
        title = self.page.title()
        self.context.close()
        assert self.problems == []
        assert title != "broken"


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("name", ["index.html", "episodes/e-001/index.html", "compare/index.html"])
def test_pages_open_without_a_complaint_and_fit(browser: Any, run: Path, name: str, width: int, scheme: str) -> None:
    with Tab(browser, run / name, width=width, scheme=scheme) as page:
        page.wait_for_timeout(50)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.locator("img:not([alt])").count() == 0
        assert page.locator("main a[href^='javascript:']").count() == 0
        assert PAYLOAD[:30] in page.locator("body").inner_text()


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["index.html", "episodes/e-001/index.html", "compare/index.html"])
def test_pages_pass_an_accessibility_check(browser: Any, run: Path, name: str, scheme: str, width: int) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed").Axe()
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, bypass_csp=True)
    page = context.new_page()
    page.goto((run / name).as_uri())
    found = axe.run(page).response["violations"]
    context.close()
    assert [(each["id"], each["nodes"][0]["html"][:120]) for each in found] == []


def test_keys_scrub_and_play(browser: Any, run: Path) -> None:
    with Tab(browser, run / "episodes/e-000/index.html") as page:
        where = page.locator("#where")
        assert where.inner_text().startswith("step 1 of 6")
        page.keyboard.press("ArrowRight")
        assert where.inner_text().startswith("step 2 of 6")
        page.keyboard.press("End")
        assert where.inner_text() == "step 6 of 6 · stage 2 of 2"
        page.keyboard.press("[")
        assert "stage 2 of 2" in where.inner_text()
        page.keyboard.press("Home")
        page.keyboard.press("Space")
        sync_api.expect(where).to_have_text(re.compile("^step 6"), timeout=30_000)
        assert page.locator("#play").get_attribute("aria-label") == "Play", "at the last step it has stopped by itself"
        page.locator("#scrub").fill("2")
        assert where.inner_text().startswith("step 3 of 6")
        assert page.url.endswith("#step=3")


def test_a_link_opens_its_step(browser: Any, run: Path) -> None:
    with Tab(browser, run / "episodes/e-001/index.html", "#step=5") as page:
        assert page.locator("#where").inner_text().startswith("step 5 of 6")
        page.locator("#stage-table a").first.click()
        sync_api.expect(page.locator("#where")).to_have_text(re.compile("stage 1"))
        page.get_by_role("link", name="Show the decisive step").click()
        sync_api.expect(page.locator("#where")).to_have_text(re.compile("^step 5"))


def test_a_direction_that_was_not_turned_to_is_named_without_a_picture(browser: Any, run: Path) -> None:
    with Tab(browser, run / "episodes/e-001/index.html") as page:
        assert page.locator(".views button").count() == 2
        assert page.locator("p.chips", has_text="Known, not turned to:").locator(".chip").all_text_contents() == ["back 0.40 m"]


def test_a_call_opens_with_its_prompt_and_reply_as_text(browser: Any, run: Path) -> None:
    with Tab(browser, run / "episodes/e-001/index.html") as page:
        page.get_by_text("Calls of models (1)").click()
        page.locator(".call summary").click()
        texts = page.locator(".call pre").all_inner_texts()
        assert texts[0].startswith("Asked: Go on.")
        assert texts[1].startswith("Answered: Go on.")
        assert all(PAYLOAD[:30] in text for text in texts)


def test_the_list_sorts_and_filters(browser: Any, run: Path) -> None:
    with Tab(browser, run / "index.html") as page:
        first = page.locator("#list tbody tr:visible a").first
        page.get_by_role("button", name="NE m").click()
        assert first.inner_text() == "e-000"
        page.get_by_role("button", name="NE m").click()
        assert first.inner_text() == "e-003"
        page.locator("#outcome").select_option("failure")
        assert page.locator("#shown").inner_text() == "2 shown"
        page.locator("#find").fill("e-001")
        assert page.locator("#list tbody tr:visible").count() == 1


def test_a_long_list_is_laid_out_in_parts(browser: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(site, "FIRST_SHOWN", 2)
    with Tab(browser, write_site(write_run(tmp_path / "run", 5))) as page:
        rows = page.locator("#list tbody tr:visible")
        assert (rows.count(), page.locator("#shown").inner_text()) == (2, "5 found, the first 2 shown")
        for _ in range(2):
            page.get_by_role("button", name="NE m").click()
        assert rows.locator("td:nth-child(2) a").all_inner_texts() == ["e-004", "e-003"]
        page.get_by_role("button", name="Show all 5").click()
        assert (rows.count(), page.locator("#shown").inner_text()) == (5, "5 shown")
        page.locator("#find").fill("e-001")
        assert rows.count() == 1


def test_the_robot_from_outside_is_shown_where_it_was_filmed(browser: Any, tmp_path: Path) -> None:
    for name, filmed in (("with", True), ("without", False)):
        run = write_run(tmp_path / name, 1)
        shutil.rmtree(run / "episodes/e-000")
        write_episode(run / "episodes/e-000", "Go.", good=True, filmed=filmed)
        write_site(run)
    with Tab(browser, tmp_path / "with/episodes/e-000/index.html", "#step=4") as page:
        assert page.locator("#external").get_attribute("src") == "images/0003_external.jpg"
        assert page.get_by_alt_text("The robot seen from behind at step 4").is_visible()
        page.get_by_label("external camera").uncheck()
        assert not page.locator("#external").is_visible()
    with Tab(browser, tmp_path / "without/episodes/e-000/index.html") as page:
        assert page.locator("#external").count() == 0


def test_broken_off_and_older_records_open_without_a_complaint(browser: Any, tmp_path: Path) -> None:
    run = write_run(tmp_path / "run", 2, "Go on." + PAYLOAD)
    killed, older = run / "episodes/e-000", run / "episodes/e-001"
    (killed / "result.json").unlink()
    events = (killed / "events.jsonl").read_text()
    (killed / "events.jsonl").write_text(events[: len(events) // 2])
    lines = [json.loads(line) for line in (older / "events.jsonl").read_text().splitlines()]
    for line in lines:  # as version 1.0 wrote them
        for name in ("camera", "T_body_camera", "origin", "external"):
            line.pop(name, None)
        if line["event"] == "decision_made":
            line.pop("sightings")
    (older / "events.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    result = json.loads((older / "result.json").read_text())
    (older / "result.json").write_text(json.dumps({**result, "format": "spacevln-record/1.0", "diagnosis": None}))
    (run / "summary.json").unlink()
    write_site(run)
    for name in ("index.html", "episodes/e-000/index.html", "episodes/e-001/index.html"):
        with Tab(browser, run / name) as page:
            page.wait_for_timeout(50)
            assert page.locator("h1").is_visible()
            if name != "index.html":
                page.keyboard.press("End")
                assert page.locator("#where").inner_text().startswith("step ")


def test_everything_is_reached_with_the_keyboard(browser: Any, run: Path) -> None:
    with Tab(browser, run / "index.html") as page:
        reached = set()
        for _ in range(60):
            page.keyboard.press("Tab")
            reached.add(page.evaluate("document.activeElement.id || document.activeElement.textContent.trim().slice(0, 20)"))
        assert {"find", "outcome", "diagnosis", "NE m", "e-000", "e-003", "budget"} <= reached
        page.get_by_role("link", name="e-001").focus()
        page.keyboard.press("Enter")
        page.wait_for_url("**/episodes/e-001/index.html")


def test_two_records_side_by_side(browser: Any, tmp_path: Path) -> None:
    write_episode(tmp_path / "a/episodes/e", "Go.", good=True)
    write_episode(tmp_path / "b/episodes/e", "Go.", good=False, direction="left 30")
    page_path = write_comparison(tmp_path / "a/episodes/e", tmp_path / "b/episodes/e", tmp_path / "both")
    for width in (1280, 390):
        with Tab(browser, page_path, width=width) as page:
            assert "planner: direction: “front” against “left 30”" in page.locator(".note").inner_text()
            assert page.locator("#side-b .instruction.differs").count() == 1
            assert page.locator(".act-of.differs").count() == 0
            page.keyboard.press("ArrowRight")
            assert page.locator("#side-b .now").inner_text() == "step 2 of 6, stage 1"
            page.keyboard.press("End")
            first = page.evaluate("document.getElementById('play').click(), document.getElementById('where').textContent")
            assert first == "step 1 of 6", "played at the end, it begins anew"
            sync_api.expect(page.locator("#play")).to_have_attribute("aria-label", "Play", timeout=30_000)
            assert page.locator("#where").inner_text() == "step 6 of 6", "it stops with the last step"
            assert page.evaluate("document.documentElement.scrollWidth") <= width
