"""What the pages are made of: templates, style sheets and scripts that may stand in a page as they are, and packed data."""

import base64
import gzip
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

if TYPE_CHECKING:
    from testbed.show.hero import Hero
    from testbed.show.player import Scene


@dataclass(frozen=True)
class PageHead:
    """A part that stands on top of a campaign's page, above its ordinary parts."""

    html: Markup
    css: Markup
    script: Markup
    nav: tuple[tuple[str, str], ...]  # id of a section, its name
    scenes: "tuple[Scene, ...]" = ()  # encounters that move on top of the page; none: those of the page's own choice
    hero: "Hero | None" = None
    """What stands above everything, in the place of what the page says of its flights by itself."""
    names: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """Axis to label to the name that people have for it: the ordinary parts of the page use it."""


def environment(package: str = "testbed.show") -> Environment:
    """Templates of a package, in its folder ``templates``, and ours: everything is escaped, a name that is missing is an error."""
    loader = ChoiceLoader([PackageLoader(package), PackageLoader("testbed.show")])
    return Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)


def asset(name: str, package: str = "testbed.show") -> Markup:
    """A style sheet or script of ours, which may stand in the page as it is."""
    return Markup(files(package).joinpath("templates", name).read_text(encoding="utf-8"))


def packed_json(data: Any) -> str:
    """Data for a script: the same text for the same data."""
    return packed(json.dumps(data, sort_keys=True, allow_nan=False, separators=(",", ":")).encode())


def packed(data: bytes) -> str:
    """Compressed, as text without any character that means something in HTML; no time stamp inside."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode("ascii")


@cache
def plotly() -> str:
    """The plot library, packed."""
    return packed(files("plotly").joinpath("package_data", "plotly.min.js").read_bytes())
