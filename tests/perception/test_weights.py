import hashlib
import re
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from click.testing import CliRunner

from spacevln.core import PrerequisiteError, UnknownNameError, UsageError
from spacevln.perception.weights import (
    FileState,
    PublishedFile,
    PublishedModel,
    WeightStore,
    catalogue,
    download,
    published_model,
)
from spacevln.perception.weights.download import Source
from spacevln.perception.weights.store import partial_of

CONTENT = bytes(range(256)) * 8000
SUM = hashlib.sha256(CONTENT).hexdigest()


class Hub(ThreadingHTTPServer):
    """A model hub on this machine: redirects to storage, states checksums, resumes, and breaks off on request."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Answer)
        self.files: dict[str, bytes] = {}
        self.stated: dict[str, str] = {}
        self.break_after: int | None = None
        self.ranges = True
        self.asked: list[tuple[str, str | None]] = []

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}"


class Answer(BaseHTTPRequestHandler):
    server: Hub

    def do_GET(self) -> None:
        asked = self.headers.get("Range")
        if not self.path.startswith("/storage"):
            self.send_response(302)
            self.send_header("Location", f"{self.server.address}/storage{self.path}")
            if self.path in self.server.stated:
                self.send_header("X-Linked-Etag", f'"{self.server.stated[self.path]}"')
            self.end_headers()
            return
        path = self.path.removeprefix("/storage")
        self.server.asked.append((path, asked))
        content = self.server.files.get(path)
        if content is None:
            self.send_error(404)
            return
        begin = int(re.findall(r"\d+", asked)[0]) if asked and self.server.ranges else 0
        if asked and begin >= len(content):
            self.send_error(416)
            return
        self.send_response(206 if begin else 200)
        self.send_header("Content-Length", str(len(content) - begin))
        self.end_headers()
        end = len(content) if self.server.break_after is None else begin + self.server.break_after
        self.wfile.write(content[begin:end])
        self.server.break_after = None

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def hub(socket_enabled: None) -> Iterator[Hub]:  # noqa: ARG001 - opens the loopback
    server = Hub()
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def model(**changes: object) -> PublishedModel:
    file = PublishedFile("weights.bin", "https://hub.example/team/model/weights.bin", **({"sha256": SUM} | changes))  # type: ignore[arg-type]
    return PublishedModel("tiny", "grounder", "made up", "Apache-2.0", "https://hub.example/team/model", (file,))


def quiet(*_: object) -> None:
    pass


def test_files_come_from_a_mirror_and_are_checked_and_sealed(hub: Hub, tmp_path: Path) -> None:
    store, wanted = WeightStore(tmp_path), model()
    hub.files["/team/model/weights.bin"] = CONTENT
    seen: list[tuple[str, int, int | None]] = []
    download(wanted, store, lambda *told: seen.append(told), Source(hub.address))
    assert store.path(wanted, wanted.files[0]).read_bytes() == CONTENT
    assert seen[-1] == ("weights.bin", len(CONTENT), len(CONTENT))
    assert store.verify(wanted).files == {"weights.bin": FileState.PRESENT}
    download(wanted, store, quiet, Source(hub.address))
    assert len(hub.asked) == 1


def test_a_broken_transfer_goes_on_where_it_stopped(hub: Hub, tmp_path: Path) -> None:
    store, wanted = WeightStore(tmp_path), model()
    hub.files["/team/model/weights.bin"], hub.break_after = CONTENT, 700_000
    with pytest.raises(PrerequisiteError, match="run the same command again to go on"):
        download(wanted, store, quiet, Source(hub.address))
    assert store.look(wanted).files == {"weights.bin": FileState.PARTIAL}
    download(wanted, store, quiet, Source(hub.address))
    assert [asked for _, asked in hub.asked] == [None, "bytes=700000-"]
    assert store.verify(wanted).complete


def test_a_server_without_ranges_starts_anew_and_a_complete_part_is_only_named(hub: Hub, tmp_path: Path) -> None:
    store, wanted = WeightStore(tmp_path), model()
    hub.files["/team/model/weights.bin"] = CONTENT
    part = partial_of(store.path(wanted, wanted.files[0]))
    part.parent.mkdir(parents=True)
    part.write_bytes(CONTENT[:1000])
    hub.ranges = False
    download(wanted, store, quiet, Source(hub.address))
    assert store.verify(wanted).complete
    store.path(wanted, wanted.files[0]).unlink()
    part.write_bytes(CONTENT)
    hub.ranges = True
    download(wanted, store, quiet, Source(hub.address))
    assert store.verify(wanted).complete


def test_what_is_not_what_was_published_is_removed(hub: Hub, tmp_path: Path) -> None:
    store, wanted = WeightStore(tmp_path), model()
    hub.files["/team/model/weights.bin"] = CONTENT[:-1] + b"!"
    with pytest.raises(UsageError, match="is not what was published"):
        download(wanted, store, quiet, Source(hub.address))
    assert store.look(wanted).files == {"weights.bin": FileState.MISSING}


def test_without_a_published_checksum_the_server_s_statement_counts(hub: Hub, tmp_path: Path) -> None:
    store, wanted = WeightStore(tmp_path), model(sha256=None)
    path = "/team/model/weights.bin"
    hub.files[path], hub.stated[path] = CONTENT, "0" * 64
    with pytest.raises(UsageError, match="is not what was published"):
        download(wanted, store, quiet, Source(hub.address))
    hub.stated[path] = SUM
    download(wanted, store, quiet, Source(hub.address))
    assert store.verify(wanted).files == {"weights.bin": FileState.PRESENT}
    file = store.path(wanted, wanted.files[0])
    file.write_bytes(CONTENT[::-1])
    assert store.look(wanted).complete
    assert store.verify(wanted).files == {"weights.bin": FileState.DAMAGED}
    file.write_bytes(CONTENT[:10])
    assert store.look(wanted).files == {"weights.bin": FileState.DAMAGED}


def test_refusals_and_silence_are_sentences(hub: Hub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(PrerequisiteError, match="404"):
        download(model(), WeightStore(tmp_path), quiet, Source(hub.address))
    with pytest.raises(PrerequisiteError, match="broke off"):
        download(model(), WeightStore(tmp_path), quiet, Source("http://127.0.0.1:9"))
    with pytest.raises(UsageError, match="no web address"):
        download(model(), WeightStore(tmp_path), quiet, Source("file:///etc"))
    monkeypatch.setenv("SPACEVLN_OFFLINE", "1")
    with pytest.raises(PrerequisiteError, match="nothing is downloaded"):
        download(model(), WeightStore(tmp_path), quiet)


def test_a_missing_weight_is_a_sentence_with_the_command(tmp_path: Path) -> None:
    store = WeightStore(tmp_path)
    with pytest.raises(PrerequisiteError, match="run spacevln models download repvit-sam"):
        store.open("repvit-sam")
    with pytest.raises(UnknownNameError, match="Did you mean 'repvit-sam'"):
        store.open("repvit-sm")
    (tmp_path / "repvit-sam").mkdir()
    (tmp_path / "repvit-sam" / "repvit_sam.pt").write_bytes(b"x")
    assert store.open("repvit-sam") == tmp_path / "repvit-sam"


def test_the_catalogue_is_complete() -> None:
    assert {model.role for model in catalogue().values()} == {"grounder", "segmenter"}
    for each in catalogue().values():
        assert each.licence
        assert all(file.url.startswith("https://") for file in each.files)
        assert all(file.sha256 is None or re.fullmatch(r"[0-9a-f]{64}", file.sha256) for file in each.files)
    assert published_model("grounding-dino-tiny").size == 689359096


def test_the_command_lists_fetches_and_verifies(hub: Hub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from spacevln.cli.app import cli

    monkeypatch.setenv("SPACEVLN_MODELS", str(tmp_path))
    monkeypatch.setenv("SPACEVLN_MODELS_MIRROR", hub.address)
    hub.files["/THU-MIG/RepViT/releases/download/v1.0/repvit_sam.pt"] = CONTENT
    run = CliRunner().invoke
    assert "-        segmenter" in run(cli, ["models", "list"]).output
    refused = run(cli, ["models", "download", "repvit-sam"], input="n\n", standalone_mode=True)
    assert "licence Apache-2.0, from https://github.com/THU-MIG/RepViT" in refused.output
    assert refused.exit_code == 1
    assert "repvit-sam is here" in run(cli, ["models", "download", "repvit-sam", "--yes"]).output
    assert "is here already" in run(cli, ["models", "download", "repvit-sam"]).output
    assert run(cli, ["models", "verify"], standalone_mode=False).return_value == 0
    (tmp_path / "repvit-sam" / "repvit_sam.pt").write_bytes(CONTENT[:-1] + b"?")
    checked = run(cli, ["models", "verify", "repvit-sam"], standalone_mode=False)
    assert checked.return_value == 3
    assert "damaged  repvit-sam/repvit_sam.pt" in checked.output
    assert "-> spacevln models download repvit-sam" in checked.output
