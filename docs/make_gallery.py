"""Writes ``gallery.html`` and the pictures in ``gallery/``: ``python docs/make_gallery.py``, or ``make gallery``; with names, only those.

Every picture is what a reader gets: a page in Chromium, a recording in the viewer, each without a window, of campaigns that are flown here
by the commands that stand below it. Needs Debian's chromium and a Vulkan driver (mesa-vulkan-drivers does in software).
"""

import io
import os
import shlex
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jinja2 import Environment
from PIL import Image

HERE = Path(__file__).parent
ROOT = HERE.parent
PICTURES, PAGE, TEMPLATE = HERE / "gallery", HERE / "gallery.html", HERE / "gallery.html.j2"
CHROMIUM = shutil.which("chromium")
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"]
BESIDE = Path(sys.executable).parent

WIDE, FILM_WIDE, QUALITY, FILM_QUALITY = 1400, 1000, 82, 62
FRAMES_PER_S, SLOWER = 12, 2.0  # of the film, and how much slower than flown it runs
FILM_MS = -700, 2600  # from and to which instant; 0 is the decision
MOST_BYTES, MOST_FILM_BYTES = 1_500_000, 2_000_000
NO_BAR = "nav { display: none !important; }"  # it stays on top of the window, and so of a part that is taller
PATIENCE_MS = 180_000  # with a page that is drawn in software
SETTLED_S = 4.0  # what the viewer takes to load and draw, in software, at most

EXAMPLE = ("run", "campaigns/paper_single.yaml")
WIND = "air.wind={kind: steady, speed_mps: 10, from_deg: 240}"
THREAT = ("obstacles.O.direction_deg=[106, 12.4]", "begin={climb_at_most_deg: 18}", "aircraft=gtm_t2")
RUNG_SWEEP = (
    "sweep={air: {calm: {air.wind: {kind: calm}}, windy: {air.wind: {kind: steady, speed_mps: 10, from_deg: 240}}}, "
    "method.kind: [none, scoam], plant.kind: [kinematic, point_mass, jsbsim]}"
)
WIND_SWEEP = (
    "sweep={air.wind.speed_mps: [0, 3, 6, 9, 12, 15], air.wind.from_deg: [0, 60, 120, 180, 240, 300], "
    "method.kind: [scoam, droam_hp], plant.kind: [kinematic, jsbsim]}"
)


RUNS = {
    "ladder": (*THREAT, "sweep={method.kind: [none, scoam], plant.kind: [kinematic, point_mass, jsbsim]}", "recordings=none"),
    "rungs": (*THREAT, RUNG_SWEEP, "recordings=all"),
    "winds": (*THREAT, "air.wind={kind: steady, speed_mps: 3, from_deg: 60}", WIND_SWEEP, "recordings=none"),
    "calm": ("recordings=none",),
    "windy": (WIND, "recordings=none"),
}
"""The runs that are pictured, and what of the example is changed for each."""


def words_of_run(directory: Path, settings: tuple[str, ...]) -> list[str]:
    """What is typed after ``testbed``."""
    return [*EXAMPLE, "--out", str(directory), *(word for setting in settings for word in ("--set", setting))]


def typed(name: str) -> str:
    """The command that flies one of the runs."""
    return f"testbed {shlex.join(words_of_run(Path('reports/runs') / name, RUNS[name]))}"


@dataclass
class Stage:
    """Where pictures are taken: a folder for the runs, each flown once, and a browser."""

    folder: Path
    browser: Any
    flown: set[str] = field(default_factory=set)

    def run(self, name: str, *settings: str) -> Path:
        """The example of the paper with some settings changed, flown."""
        directory = self.folder / name
        if name not in self.flown:
            self.testbed(*words_of_run(directory, settings))
            self.flown.add(name)
        return directory

    def testbed(self, *words: str) -> None:
        """The command, as a reader types it."""
        print(f"testbed {shlex.join(words)}", flush=True)
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep)}
        done = subprocess.run([str(BESIDE / "testbed"), *words], cwd=ROOT, env=environment, check=False, capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(done.stderr)

    def recording(self, run: Path, label: str) -> Path:
        """The recording of the flight of a run whose cell is named so."""
        import pandas as pd

        rows = pd.read_csv(run / "results.csv")
        (flight,) = rows.loc[rows["cell"] == label, "flight_id"]
        return run / "recordings" / f"{flight}.rrd"

    @contextmanager
    def page(self, file: Path, wide: int, high: int) -> Iterator[Any]:
        """A page of ours, when it has drawn itself."""
        page = self.browser.new_page(viewport={"width": wide, "height": high}, reduced_motion="reduce")  # it stands still to be pictured
        page.set_default_timeout(PATIENCE_MS)
        page.goto(file.resolve().as_uri())
        page.wait_for_timeout(2500)
        yield page
        page.close()


Maker = Callable[[Stage], list[Image.Image]]


@dataclass(frozen=True)
class Picture:
    """A picture of the gallery: one image, or the frames of a film. ``commands``: what a reader types to have it."""

    name: str
    title: str
    says: str
    commands: tuple[str, ...]
    make: Maker

    @property
    def file(self) -> Path:
        return PICTURES / f"{self.name}.webp"


def top_of(file: str, high: int) -> Maker:
    """The first screen of a page that is committed."""

    def make(stage: Stage) -> list[Image.Image]:
        with stage.page(ROOT / file, WIDE, high) as page:
            return [_image(page.screenshot())]

    return make


def part_of(file: Callable[[Stage], Path], part: str, wide: int = WIDE) -> Maker:
    """A part of a page, by its selector."""

    def make(stage: Stage) -> list[Image.Image]:
        with stage.page(file(stage), wide, 900) as page:
            return [_image(page.locator(part).screenshot(style=NO_BAR))]

    return make


def film_of(file: Callable[[Stage], Path], part: str, slider: str) -> Maker:
    """A part of a page that moves, frame by frame: its slider is set to each instant."""

    def make(stage: Stage) -> list[Image.Image]:
        with stage.page(file(stage), FILM_WIDE, 900) as page:
            ends = [int(page.locator(slider).get_attribute(end)) for end in ("min", "max")]
            first, last = max(ends[0], FILM_MS[0]), min(ends[1], FILM_MS[1])
            step = 1000.0 / (FRAMES_PER_S * SLOWER)
            frames = []
            for k in range(int((last - first) / step) + 1):
                page.evaluate(
                    "([at, to]) => { const node = document.querySelector(at); node.value = to; node.dispatchEvent(new Event('input')); }",
                    [slider, str(round(first + k * step))],
                )
                page.wait_for_timeout(40)
                frames.append(_image(page.locator(part).screenshot()))
        return frames

    return make


def viewed(file: Callable[[Stage], Path], at_s: float) -> Maker:
    """A recording in the viewer, so long after the decision."""

    def make(stage: Stage) -> list[Image.Image]:
        from rerun.experimental import ViewerClient

        local = stage.folder / "rerun"  # spawn() cannot say that the viewer shall listen on this machine only
        local.write_text(f'#!/bin/sh\nexec "{BESIDE / "rerun"}" --bind 127.0.0.1 "$@"\n')
        local.chmod(0o755)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        with ViewerClient.spawn(headless=True, port=port, executable_path=str(local)) as viewer:
            viewer.open(str(file(stage)))
            time.sleep(SETTLED_S)
            viewer.set_time("encounter", duration=at_s, play_state="paused")
            time.sleep(SETTLED_S)
            return [_image(viewer.take_screenshot(max_size=WIDE))]

    return make


def together(files: Callable[[Stage], list[Path]]) -> Maker:
    """Images side by side, two in a row, in one."""

    def make(stage: Stage) -> list[Image.Image]:
        images = [Image.open(file).convert("RGB") for file in files(stage)]
        wide, high = images[0].size
        sheet = Image.new("RGB", (2 * wide, -(-len(images) // 2) * high), "white")
        for k, image in enumerate(images):
            sheet.paste(image, (k % 2 * wide, k // 2 * high))
        return [sheet]

    return make


def _image(png: bytes) -> Image.Image:
    return Image.open(io.BytesIO(png)).convert("RGB")


def _rungs(stage: Stage) -> Path:
    """The paper's encounter on every rung, in calm air and in a wind."""
    return stage.run("rungs", *RUNS["rungs"])


def _calm(stage: Stage) -> Path:
    return stage.run("calm", *RUNS["calm"])


def _compared(stage: Stage) -> Path:
    page = stage.folder / "compared.html"
    stage.testbed("compare", str(_calm(stage)), str(stage.run("windy", *RUNS["windy"])), "--out", str(page))
    return page


def _swept(stage: Stage) -> Path:
    return stage.run("winds", *RUNS["winds"]) / "index.html"


def _opening(stage: Stage) -> Path:
    return stage.recording(_rungs(stage), "calm/scoam/jsbsim")


def _overlay(stage: Stage) -> Path:
    file = stage.folder / "overlay.rrd"
    stage.testbed("overlay", str(_rungs(stage)), "calm/scoam/jsbsim", "--out", str(file))
    return file


def _figures(stage: Stage) -> list[Path]:
    folder = stage.folder / "figures"
    stage.testbed("figures", "--out", str(folder))
    return [folder / f"figure_{number:02d}.png" for number in (1, 3, 7, 11)]


FILM = Picture(
    "encounter",
    "The encounter moves in the page",
    "The flights of one encounter as ghosts in one scene, aligned at the decision: the point on rails keeps clear, the aircraft does not.",
    (typed("ladder"), "testbed open ladder"),
    film_of(lambda stage: stage.run("ladder", *RUNS["ladder"]) / "index.html", "#ep", "#ep-at"),
)
SIX = (
    Picture(
        "verdict",
        "The answer first",
        "What became of the paper's claims when they were flown, with the figure and the number of flights behind each.",
        ("make paper", "testbed open paper"),
        top_of("reports/paper/index.html", 900),
    ),
    Picture(
        "axes",
        "A metric over the axes of a sweep",
        "Wind by speed and direction, two methods, on rails and flown; each point is a cell.",
        (typed("winds"), "testbed open winds"),
        part_of(_swept, "#over-axis"),
    ),
    Picture(
        "recording",
        "A recording, as it opens",
        "The aircraft at the encounter, what its planner has decided, and its clearance on a scale on which metres are seen.",
        (typed("rungs"), "testbed open rungs FLIGHT"),
        viewed(_opening, 1.5),
    ),
    Picture(
        "overlay",
        "All rungs in one scene",
        "The same encounter and decision on rails, by the point with limits, and flown: what breaks, and at which step.",
        ("testbed overlay reports/runs/rungs calm/scoam/jsbsim",),
        viewed(_overlay, 1.95),
    ),
    Picture(
        "figures",
        "The paper's figures from the product's own geometry",
        "Collision cone, velocity sphere, spherical caps and the path around the obstacle: four of fourteen, numbered as in the paper.",
        ("testbed figures --out figures/",),
        together(_figures),
    ),
    Picture(
        "compare",
        "Two runs, pair by pair",
        "The same flights in calm air and in a wind of 10 m/s: who gains, who loses, and by how much.",
        (typed("calm"), typed("windy"), "testbed compare calm windy --out compared.html"),
        part_of(_compared, "#slopes"),
    ),
)
ALL = (FILM, *SIX)


def page_text() -> str:
    """The gallery."""
    return Environment(autoescape=True, trim_blocks=True).from_string(TEMPLATE.read_text(encoding="utf-8")).render(pictures=ALL) + "\n"


def save(picture: Picture, images: list[Image.Image]) -> None:
    """One image, or a film that runs for ever."""
    wide = FILM_WIDE if picture is FILM else WIDE
    sized = [
        one.resize((wide, round(one.height * wide / one.width)), Image.Resampling.LANCZOS) if one.width > wide else one for one in images
    ]
    first, *rest = sized
    more = {"save_all": True, "append_images": rest, "duration": round(1000 / FRAMES_PER_S), "loop": 0} if rest else {}
    first.save(picture.file, "WEBP", quality=FILM_QUALITY if rest else QUALITY, method=4, **more)
    print(f"{picture.file.relative_to(ROOT)}: {picture.file.stat().st_size / 1000:.0f} kB, {words_of(sized)}", flush=True)


def words_of(images: list[Image.Image]) -> str:
    """Size of an image, and how many there are."""
    return f"{images[0].width} x {images[0].height}" + (f", {len(images)} frames" if len(images) > 1 else "")


def too_large() -> list[str]:
    """What is over the size that is kept in the repository."""
    six = sum(one.file.stat().st_size for one in SIX if one.file.exists())
    film = FILM.file.stat().st_size if FILM.file.exists() else 0
    told = [(six, MOST_BYTES, "the six pictures"), (film, MOST_FILM_BYTES, "the film")]
    return [f"{what}: {size} B, more than {most} B" for size, most, what in told if size > most]


def main(names: list[str]) -> int:
    """Take pictures, all or those named."""
    if unknown := set(names) - {one.name for one in ALL}:
        print(f"no picture {', '.join(sorted(unknown))}; there are: {', '.join(one.name for one in ALL)}", file=sys.stderr)
        return 2
    if CHROMIUM is None:
        print("no chromium (Debian: chromium)", file=sys.stderr)
        return 2
    from playwright.sync_api import sync_playwright

    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        stage = Stage(Path(folder), browser)
        for picture in ALL:
            if not names or picture.name in names:
                save(picture, picture.make(stage))
        browser.close()
    PAGE.write_text(page_text(), encoding="utf-8")
    for problem in (problems := too_large()):
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
