"""``spacevln houses``: look at the embedded houses, list what is in them, export them."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from spacevln.environments.houses.plan import House, Rect, Room

SEED = click.option("--seed", type=click.IntRange(0, 999_999), default=9, show_default=True, help="Which house.")
THUMB_PX = (400, 300)
COLUMNS = 3


@click.group()
def houses() -> None:
    """Look at the embedded houses, list what is in them, export them."""


@houses.command()
@SEED
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), default=None, help="PNG file.")
def render(seed: int, out: Path | None) -> None:
    """Write a sheet with a view into every room."""
    from PIL import Image, ImageDraw, ImageFont

    from spacevln.core import UsageError
    from spacevln.environments.houses.furniture.sheets import render_views, room_views
    from spacevln.environments.houses.ground.walkable import Walkable
    from spacevln.environments.houses.house import build_house

    house = build_house(seed)
    space = Walkable(house)
    shown = [(room, view) for room in house.rooms for view in room_views(house, room, space, count=1)]
    images = render_views(house, [view for _, view in shown])
    width, height = THUMB_PX
    rows = -(-len(shown) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * width, rows * (height + 24)), "white")
    draw = ImageDraw.Draw(sheet)
    for index, ((room, _), image) in enumerate(zip(shown, images, strict=True)):
        x, y = index % COLUMNS * width, index // COLUMNS * (height + 24)
        sheet.paste(Image.fromarray(image).resize(THUMB_PX), (x, y + 24))
        draw.text((x + 6, y + 4), f"{room.type}, floor {room.floor + 1}", fill="black", font=ImageFont.load_default(14))
    path = out or Path(f"house-{seed:06d}.png")
    try:
        sheet.save(path)
    except OSError as error:
        raise UsageError(f"--out {str(path)!r} cannot be written ({error.strerror}): give a file that you may write.") from error
    click.echo(path)


@houses.command()
@SEED
def describe(seed: int) -> None:
    """List floors, rooms, doors and things."""
    from spacevln.environments.houses.house import build_house

    house = build_house(seed)
    kinds = Counter(opening.kind for opening in house.openings)
    openings = ", ".join(f"{count} {kind}s" for kind, count in sorted(kinds.items()))
    click.echo(f"{house.name}: {len(house.floors)} floor(s), {len(house.rooms)} rooms, {openings}, {len(house.items)} things")
    for room in house.rooms:
        click.echo(f"  {room.type}, floor {room.floor + 1}, {room.area:.1f} m2, to {', '.join(_neighbours(house, room))}")
        things = [" ".join((*item.attributes, item.category)) for item in house.items if item.room == room.id]
        click.echo(f"    {', '.join(things)}")


def _neighbours(house: House, room: Room) -> list[str]:
    names = {each.id: each.type for each in house.rooms}
    found = []
    for opening in house.openings:
        if opening.kind != "window" and room.id in opening.rooms:
            other = next((each for each in opening.rooms if each != room.id), None)
            found.append(f"{names[other]} ({opening.kind})" if other is not None else opening.kind)
    storeys = [(stairs.rect, stairs.lower_floor) for stairs in house.stairs]
    return found + ["stairs" for rect, lower in storeys if room.floor in (lower, lower + 1) and _touches(rect, room)]


def _touches(rect: Rect, room: Room) -> bool:
    return any(r.x0 <= rect.x1 and rect.x0 <= r.x1 and r.y0 <= rect.y1 and rect.y0 <= r.y1 for r in room.rects)


@houses.command()
@click.option("--seed", type=click.IntRange(0, 999_999), default=None, help="Which house.  [default: 9]")
@click.option("--format", "form", type=click.Choice(["glb", "habitat"]), default="glb", show_default=True)
@click.option(
    "--suite",
    "suites",
    type=click.Choice(["houses-vln", "houses-objectnav"]),
    multiple=True,
    help="Its houses, with its episodes.",
)
@click.option("--split", type=click.Choice(["test", "dev"]), default="test", show_default=True, help="Of the suite.")
@click.option("--houses", "count", type=click.IntRange(min=1), default=None, help="Only the suite's first so many houses.")
@click.option("--out", type=click.Path(path_type=Path), default=None, help="The .glb file, or for habitat the folder.")
def export(seed: int | None, form: str, suites: tuple[str, ...], split: str, count: int | None, out: Path | None) -> None:
    """Write furnished houses for other programs.

    As one glTF file (.glb), or with all that Habitat-Sim wants: semantic annotations, configurations, and a suite's episodes.
    """
    from spacevln.environments.houses.export import export_glb
    from spacevln.environments.houses.habitat_export import export_for_habitat
    from spacevln.environments.houses.house import build_house

    if suites and (form != "habitat" or seed is not None):
        raise click.UsageError("--suite belongs to --format habitat and names the houses itself: leave --seed out.")
    first = 9 if seed is None else seed
    if form == "glb":
        click.echo(export_glb(build_house(first), out or Path(f"house-{first:06d}.glb")))
        return
    folder = out or Path("habitat-houses")
    files = [_write_suite(name, split, count, folder) for name in suites]
    seeds = sorted({each for file in files for each in _houses_of(file)}) if files else [first]
    for each in seeds:
        click.echo(export_for_habitat(build_house(each), folder / "scenes"))
    for file in files:
        click.echo(file)


def _houses_of(suite: Path) -> list[int]:
    """Seeds of the houses that a suite's file names."""
    import gzip
    import json

    from spacevln.environments.houses.house import parse_scene_name

    episodes = json.loads(gzip.decompress(suite.read_bytes()))["episodes"]
    return [parse_scene_name(Path(each["scene_id"]).stem) for each in episodes]


@houses.command()
@click.argument("name", type=click.Choice(["houses-vln", "houses-objectnav"]))
@click.option("--split", type=click.Choice(["test", "dev"]), default="test", show_default=True)
@click.option("--houses", "count", type=click.IntRange(min=1), default=None, help="Only the first so many houses.")
@click.option(
    "--out", type=click.Path(path_type=Path, file_okay=False), default=Path("suites"), show_default=True, help="Folder."
)
def suite(name: str, split: str, count: int | None, out: Path) -> None:
    """Write a stored suite in the file format of R2R-CE or HM3D-OVON; `bench --data FILE` runs it."""
    click.echo(_write_suite(name, split, count, out))


def _write_suite(name: str, split: str, count: int | None, folder: Path) -> Path:
    from dataclasses import replace

    from rich.progress import Progress

    from spacevln.evaluation.stored import copy_suite
    from spacevln.evaluation.suites import PLANS, write_suite

    if count is None:
        return copy_suite(name, split, folder)
    with Progress(transient=True) as bar:
        task = bar.add_task("houses", total=count)
        plan = replace(PLANS[split], houses=count)
        return write_suite(name, split, folder, plan, lambda done: bar.update(task, completed=done))
