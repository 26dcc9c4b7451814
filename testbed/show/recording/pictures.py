"""Numbered figures as one recording: a tab for each, with its numbers beside it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from testbed.show import palette, shapes
from testbed.show.drawing import INKS, Arrow, Body, Dot, Line, Picture, Sphere, Thing
from testbed.show.palette import rgba
from testbed.show.recording.file import readable, written

Array = np.ndarray
NIGHT = 1  # of the two inks of everything


def write_pictures(pictures: Sequence[Picture], title: str, path: Path) -> None:
    """Write them all into one file, the first one open."""
    with written(path, title, "figures", _blueprint(pictures)) as stream:
        for picture in pictures:
            root = f"figure_{picture.number:02d}"
            stream.log(root, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
            stream.log(f"values/{root}", rr.TextDocument(readable(_values(picture)), media_type="text/markdown"), static=True)
            for k, thing in enumerate(picture.things):
                stream.log(f"{root}/{type(thing).__name__.lower()}_{k:02d}", *_logged(thing), static=True)


def _logged(thing: Thing) -> list[rr.AsComponents]:
    colour = INKS[thing.ink][NIGHT]
    if isinstance(thing, Sphere):
        net = [thing.centre + thing.radius * line for line in shapes.graticule()]
        return [rr.LineStrips3D(net, colors=rgba(palette.dimmed(colour)), radii=rr.Radius.ui_points(0.5))]
    if isinstance(thing, Body):
        return [rr.Mesh3D(vertex_positions=thing.points, triangle_indices=thing.triangles, albedo_factor=rgba(colour, thing.opacity))]
    if isinstance(thing, Line):
        shade = palette.dimmed(colour) if thing.dashed else colour  # the viewer has no dashes
        return [rr.LineStrips3D([thing.points], colors=rgba(shade), radii=rr.Radius.ui_points(0.7 * thing.width))]
    if isinstance(thing, Arrow):
        return [rr.Arrows3D(origins=[thing.origin], vectors=[thing.vector], colors=rgba(colour), radii=rr.Radius.ui_points(thing.width))]
    if isinstance(thing, Dot):
        return [rr.Points3D([thing.place], colors=rgba(colour), radii=rr.Radius.ui_points(thing.size))]
    label = readable(plain(thing.text))
    return [rr.Points3D([thing.place], labels=[label], colors=rgba(colour), radii=rr.Radius.ui_points(0.1))]


def plain(text: str) -> str:
    """Without the brackets of an index."""
    return text.replace("{", "").replace("}", "").replace("\N{CIRCLED PLUS}", "+")


def _values(picture: Picture) -> str:
    """The table beside a figure."""
    lines = [
        f"| {plain(value.sign).replace('|', '&#124;')} | {_cell(value.what)} | {value.text} | {value.printed} |" for value in picture.values
    ]
    head = "| | | computed | printed |\n|---|---|---:|---:|"
    return "\n".join([f"#### Fig. {picture.number}: {plain(picture.title)}", "", head, *lines, "", plain(picture.note)])


def _cell(text: str) -> str:
    return plain(text).replace("|", "&#124;")


def _blueprint(pictures: Sequence[Picture]) -> rrb.Blueprint:
    tabs = [rrb.Horizontal(_view(picture), _document(picture), column_shares=[3, 2], name=f"Fig. {picture.number}") for picture in pictures]
    panels = (rrb.TimePanel(state="hidden"), rrb.BlueprintPanel(state="hidden"), rrb.SelectionPanel(state="hidden"))
    return rrb.Blueprint(rrb.Tabs(*tabs, active_tab=0), *panels, auto_views=False, auto_layout=False)


def _view(picture: Picture) -> rrb.Spatial3DView:
    points = np.vstack([point for thing in picture.things for point in _points(thing, picture)])
    low, high = points.min(axis=0), points.max(axis=0)
    centre, reach = (low + high) / 2.0, float(np.linalg.norm(high - low))
    eye = centre + 0.85 * reach * np.asarray(picture.towards)
    return rrb.Spatial3DView(
        origin=f"/figure_{picture.number:02d}",
        name=f"Fig. {picture.number} ({picture.unit})",
        background=rgba(palette.NIGHT),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=eye, look_target=centre, eye_up=(0, 0, 1)),
    )


def _points(thing: Thing, picture: Picture) -> Array:
    """What has to be in the view."""
    if isinstance(thing, Sphere):
        reach = 0.0 if picture.sphere_around else thing.radius
        return thing.centre + reach * np.vstack([np.eye(3), -np.eye(3)])
    if isinstance(thing, Line | Body):
        return thing.points
    return np.array([thing.origin, thing.origin + thing.vector]) if isinstance(thing, Arrow) else thing.place[None]


def _document(picture: Picture) -> rrb.TextDocumentView:
    return rrb.TextDocumentView(origin=f"/values/figure_{picture.number:02d}", name="Values")
