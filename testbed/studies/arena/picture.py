"""The picture that leads the page: share kept against lead, one line a method, one small picture a place. Static SVG."""

from collections.abc import Mapping, Sequence

from markupsafe import Markup, escape

from testbed.studies.arena.flights import CONTROL
from testbed.studies.arena.ranks import Judged, Share

WIDTH, HEIGHT = 300, 190
LEFT, RIGHT, TOP, BOTTOM = 30, 8, 8, 32
BESIDE = 2.2  # coloured lines that coincide lie side by side
KEY = Markup('<li><svg viewBox="0 0 24 8" aria-hidden="true"><line class="line {}" x1="0" y1="4" x2="24" y2="4"/></svg>{}</li>')


def leaders(judged: Judged) -> dict[str, str]:
    """The best method of each shape, over the places with most of flight, to the class of its colour; in order of their ranks."""
    found: dict[str, str] = {}
    for one in judged.places.get(judged.overall, ()):
        if one.shape != CONTROL:
            found.setdefault(one.shape, one.method)
    return {method: f"c{k}" for k, method in enumerate(found.values(), 1)}


def picture(judged: Judged) -> Markup:
    """All places, and what the colours stand for."""
    coloured = leaders(judged)
    keys = [KEY.format(css, f"{method}, the best {judged.shapes[method]}") for method, css in coloured.items()]
    rest = sum(shape != CONTROL for shape in judged.shapes.values()) - len(coloured)
    keys += [KEY.format("rest", f"{rest} others")] if rest else []
    longest = max((lead for by_method in judged.leads.values() for of in by_method.values() for lead in of), default=1.0)
    rungs, who = (list(dict.fromkeys(of)) for of in zip(*judged.leads, strict=True)) if judged.leads else ([], [])
    panels = [
        Markup('<figure style="--column:{};--row:{}"><figcaption>{}</figcaption>{}</figure>').format(
            rungs.index(place.rung) + 1,
            who.index(place.flown_by) + 1,
            title(place.rung, place.flown_by, judged),
            panel(by_method, judged.shapes, coloured, longest),
        )
        for place, by_method in judged.leads.items()
    ]
    return Markup('<ul class="legend">{}</ul><div class="panels" style="--columns:{}">{}</div>').format(
        Markup().join(keys), len(rungs), Markup().join(panels)
    )


def title(rung: str, flown_by: str, judged: Judged) -> str:
    """A place by its name: the aircraft is named where there are several."""
    several = len({place.flown_by for place in judged.leads if place.rung == rung}) > 1
    told = rung.replace("_", " ")
    return f"{told}, {flown_by}" if several else told


def panel(by_method: Mapping[str, Mapping[float, Share]], shapes: Mapping[str, str], coloured: Mapping[str, str], longest: float) -> Markup:
    """Those of one place; the coloured lines come last, so that they lie on top."""
    parts = [_frame(sorted({lead for of in by_method.values() for lead in of}), longest)]
    racing = [method for method in by_method if shapes[method] != CONTROL]
    for method in sorted(racing, key=lambda name: name in coloured):
        aside = BESIDE * list(coloured).index(method) if method in coloured else 0.0
        points = [(_x(lead, longest), _y(share.share) + aside) for lead, share in by_method[method].items()]
        parts.append(_line(points, coloured.get(method, "rest"), method))
    return Markup("".join([*parts, "</svg>"]))


def _line(points: Sequence[tuple[float, float]], css: str, method: str) -> str:
    places = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dots = "".join(f'<circle class="dot {css}" cx="{x:.1f}" cy="{y:.1f}" r="2.6"/>' for x, y in points) if css != "rest" else ""
    return f'<g><title>{escape(method)}</title><polyline class="line {css}" points="{places}"/>{dots}</g>'


def _frame(leads: Sequence[float], longest: float) -> str:
    foot = HEIGHT - BOTTOM
    grid = "".join(
        f'<line class="grid" x1="{LEFT}" y1="{_y(share):.1f}" x2="{WIDTH - RIGHT}" y2="{_y(share):.1f}"/>'
        f'<text x="{LEFT - 5}" y="{_y(share) + 4:.1f}" text-anchor="end">{100.0 * share:.0f}</text>'
        for share in (0.0, 0.5, 1.0)
    )
    ticks = "".join(f'<text x="{_x(lead, longest):.1f}" y="{foot + 14}" text-anchor="middle">{lead:g}</text>' for lead in leads)
    label = f'<text x="{0.5 * (LEFT + WIDTH):.0f}" y="{HEIGHT - 4}" text-anchor="middle">lead, s</text>'
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="Flights that keep every radius, %, by lead">{grid}{ticks}{label}'


def _x(lead_s: float, longest: float) -> float:
    return LEFT + 8 + (WIDTH - LEFT - RIGHT - 16) * lead_s / longest


def _y(share: float) -> float:
    return TOP + (HEIGHT - TOP - BOTTOM) * (1.0 - share)
