"""The figures on disk: SVG, PNG where there is a browser to draw them, one recording, and every number in a table."""

import csv
import io
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from testbed.show.drawing import Picture
from testbed.show.svg_picture import HEIGHT, WIDTH, svg
from testbed.studies.scoam.figures.encounters import figures

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
SCALE = 1.5  # pixels of a PNG for one of the SVG; all figures in one column stay below what a browser can picture at once
PATIENCE_S = 120.0


def write_figures(out: Path) -> list[Path]:
    """Write ``figure_01.svg`` to ``figure_14.svg``, as many PNG if a browser is found, ``values.csv`` and ``figures.rrd``."""
    out.mkdir(parents=True, exist_ok=True)
    drawn, written = figures(), []
    for picture in drawn:
        file = out / f"figure_{picture.number:02d}.svg"
        file.write_text(svg(picture), encoding="utf-8", newline="\n")
        written.append(file)
    written += _pictured(written)
    table = out / "values.csv"
    table.write_text(values_csv(drawn), encoding="utf-8", newline="\n")
    from testbed.show.recording.pictures import write_pictures

    recording = out / "figures.rrd"
    write_pictures(drawn, "The paper's figures", recording)
    return [*written, table, recording]


def values_csv(drawn: Sequence[Picture]) -> str:
    """One line a number, the parts of a vector separated by spaces; as many digits as a float has."""
    sink = io.StringIO()
    write = csv.writer(sink, lineterminator="\n").writerow
    write(["figure", "sign", "what", "value", "unit", "printed"])
    for picture in drawn:
        for value in picture.values:
            parts = value.value if isinstance(value.value, tuple) else (value.value,)
            write([picture.number, value.sign, value.what, " ".join(f"{float(part):.9g}" for part in parts), value.unit, value.printed])
    return sink.getvalue()


def browser() -> str | None:
    """A browser that can draw without a screen."""
    return next((found for name in BROWSERS if (found := shutil.which(name))), None)


def _pictured(files: Sequence[Path]) -> list[Path]:
    """PNG of SVG files beside them: drawn by the browser in one column, and cut apart. None without a browser."""
    program = browser()
    if program is None:
        return []
    from PIL import Image

    with TemporaryDirectory() as folder:
        page, column = Path(folder) / "column.html", Path(folder) / "column.png"
        bodies = "".join(file.read_text(encoding="utf-8") for file in files)
        page.write_text(
            f'<!doctype html><meta charset="utf-8"><style>body{{margin:0}}svg{{display:block}}</style>{bodies}', encoding="utf-8"
        )
        asked = [
            program, "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={folder}/profile",
            f"--force-device-scale-factor={SCALE}", f"--window-size={WIDTH},{HEIGHT * len(files)}", f"--screenshot={column}", page.as_uri(),
        ]  # fmt: skip
        subprocess.run(asked, capture_output=True, timeout=PATIENCE_S, check=False)
        if not column.is_file():
            return []
        written = []
        with Image.open(column) as whole:
            width, height = round(WIDTH * SCALE), round(HEIGHT * SCALE)
            for k, file in enumerate(files):
                whole.crop((0, k * height, width, (k + 1) * height)).save(file.with_suffix(".png"), optimize=True)
                written.append(file.with_suffix(".png"))
    return written
