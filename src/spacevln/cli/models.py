"""``spacevln models``: what weights there are, which are here, fetching and checking them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from spacevln.perception.weights import PublishedModel

MEGABYTE = 1_000_000


@click.group()
def models() -> None:
    """Weights of detectors and segmenters: list, download, verify.

    They lie in the folder that SPACEVLN_MODELS names, else in your cache folder. Nothing is ever downloaded but by the download
    command; SPACEVLN_OFFLINE=1 forbids that too.
    """


@models.command("list")
def list_models() -> int:
    """Say which models there are, and which of them are here."""
    from spacevln.perception.weights import FileState, WeightStore, catalogue

    store = WeightStore.default()
    for model in catalogue().values():
        state = store.look(model)
        words = "here" if state.complete else "in part" if set(state.files.values()) - {FileState.MISSING} else "-"
        click.echo(f"{model.name:24s} {words:8s} {model.role:10s} {_size(model):>12s}  {model.licence:12s} {model.about}")
    click.echo(f"folder   {store.root}")
    return 0


@models.command("download")
@click.argument("names", nargs=-1, required=True, metavar="MODEL...")
@click.option("--yes", is_flag=True, help="Do not ask.")
@click.option("--mirror", default=None, help="Address that replaces the publishers' sites (or SPACEVLN_MODELS_MIRROR).")
def download_models(names: tuple[str, ...], yes: bool, mirror: str | None) -> int:
    """Fetch MODEL... after showing licence, source and size; a broken transfer goes on where it stopped."""
    from spacevln.perception.weights import WeightStore, download, published_model
    from spacevln.perception.weights.download import Source

    source = Source.default(mirror)
    store = WeightStore.default()
    for model in [published_model(name) for name in names]:
        if store.verify(model).complete:
            click.echo(f"{model.name} is here already")
            continue
        click.echo(
            f"{model.name}: {model.about}; licence {model.licence}, from {model.source}, {_size(model)}, to {store.folder(model)}"
        )
        if not yes:
            click.confirm("Download it?", abort=True)
        download(model, store, _Teller().tell, source)
        click.echo(f"{model.name} is here")
    return 0


@models.command("verify")
@click.argument("names", nargs=-1, metavar="[MODEL...]")
def verify_models(names: tuple[str, ...]) -> int:
    """Read every byte of MODEL... (by default of all that are here) and compare checksums."""
    from spacevln.perception.weights import FileState, WeightStore, catalogue, published_model

    store = WeightStore.default()
    chosen = [published_model(name) for name in names] or [
        model for model in catalogue().values() if set(store.look(model).files.values()) != {FileState.MISSING}
    ]
    bad = 0
    for model in chosen:
        state = store.verify(model)
        bad += not state.complete
        for name, of_file in state.files.items():
            click.echo(f"{of_file:8s} {model.name}/{name}")
        if not state.complete:
            click.echo(f"         -> spacevln models download {model.name}")
    if not chosen:
        click.echo(f"no models in {store.root}")
    return 3 if bad else 0


def _size(model: PublishedModel) -> str:
    known = model.size
    return "size unknown" if known is None else f"{known / MEGABYTE:,.0f} MB"


class _Teller:
    """Says how far a file is, every tenth of it."""

    def __init__(self) -> None:
        self._told: tuple[str, int] = ("", -1)

    def tell(self, name: str, have: int, total: int | None) -> None:
        """See :data:`spacevln.perception.weights.Progress`."""
        tenth = have * 10 // total if total else have // (100 * MEGABYTE)
        if (name, tenth) != self._told:
            self._told = (name, tenth)
            click.echo(f"  {name}: {have / MEGABYTE:,.0f}" + (f" of {total / MEGABYTE:,.0f} MB" if total else " MB"))
