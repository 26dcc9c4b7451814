"""The encounter from near and from behind: cameras, the way to the sphere's surface, the wind at the aircraft, and words in the picture."""

import math
from dataclasses import dataclass

import numpy as np
import rerun as rr

from testbed.flight.record import FlightRecord, inside
from testbed.show import airflow, labels, palette, words
from testbed.show.cameras import ASPECT, FOV_DEG, Shot, chase, close_up
from testbed.show.encounter import Window, to_surface
from testbed.show.palette import rgba
from testbed.show.recording.scene import SCENE_HZ, log_arrow, log_label
from testbed.show.recording.timeline import TICK_S, Clock, thinned
from testbed.show.words import number

Array = np.ndarray
WORDS_HZ, STREAK_HZ, OUTSIDE_HZ = 20.0, 20.0, 5.0
ARROW = 0.3  # an arrow at the aircraft has this share of the picture's height at the set speed
ROOM = np.array([0.22, 0.09])  # how far a text is from what it is about, in heights of the picture: texts are wider than they are high
SHEET = labels.Sheet()
STREAK_BOX = 6.0  # spans from the aircraft to the side of the box of streaks


@dataclass(frozen=True)
class Film:
    """What the cameras follow, at the same rows: aircraft, nearest obstacle, the way to its surface, and the air; None in calm air."""

    time_s: Array
    own: Array
    vel: Array
    gap: Array
    clearance_m: Array
    wind: Array | None
    shots: dict[str, Shot]


def filmed(record: FlightRecord, window: Window, rows: Array, span_m: float) -> Film | None:
    """The flight as the cameras see it; None while the obstacle is nowhere."""
    columns, name = record.columns, window.obstacle
    centre = columns[f"obstacle.{name}.pos_enu_m"]
    rows = _denser_inside(rows[np.isfinite(centre[rows]).all(axis=1)], record, window)
    if not len(rows):
        return None
    radius_m = next(spec.radius_m for spec in record.plan.obstacles if spec.name == name)
    time_s, own, vel = (columns[signal][rows] for signal in ("time_s", "own.pos_enu_m", "own.vel_enu_mps"))
    gap = to_surface(own, centre[rows], radius_m)
    closest = int(np.argmin(np.abs(time_s - window.closest_s)))
    other = columns[f"obstacle.{name}.vel_enu_mps"][rows]
    shots = {"close": close_up(own, vel, centre[rows], other, gap, closest, span_m), "chase": chase(time_s, own, vel, span_m)}
    wind = columns["air.wind_enu_mps"][rows] if "air.wind_enu_mps" in columns else np.zeros_like(own)
    clearance = columns[f"obstacle.{name}.clearance_m"][rows]
    return Film(time_s, own, vel, gap, clearance, None if airflow.is_calm(wind) else wind, shots)


def _denser_inside(rows: Array, record: FlightRecord, window: Window) -> Array:
    """Rows of the encounter as often as anything is pictured; before and after it as often as is needed to find it."""
    hz, time_s = record.plan.rates.plant_hz, record.columns["time_s"]
    within = (time_s[rows] >= window.begin_s - TICK_S) & (time_s[rows] <= window.end_s + TICK_S)
    parts = [thinned(rows[within], SCENE_HZ, hz), *(thinned(part, OUTSIDE_HZ, hz) for part in (rows[~within],) if len(part))]
    return np.unique(np.concatenate(parts))


def log(clock: Clock, record: FlightRecord, film: Film, name: str, span_m: float) -> None:
    """Cameras, clearance, wind and words."""
    for camera, shot in film.shots.items():
        log_camera(clock, f"world/camera/{camera}", film.time_s, shot)
    colours = alarm(film.clearance_m)
    clock.static("world/clearance", rr.Arrows3D.from_fields(radii=rr.Radius.ui_points(1.5)))
    clock.send("world/clearance", film.time_s, lambda k: rr.Arrows3D.columns(origins=film.own[k], vectors=film.gap[k], colors=colours[k]))
    for view, shot in film.shots.items():
        _log_arrows(clock, view, film, ARROW * shot.height_m / record.plan.speed_mps)
    if film.wind is not None:
        _log_streaks(clock, film, film.wind, span_m)
    _log_words(clock, record, film, name)


def log_camera(clock: Clock, entity: str, time_s: Array, shot: Shot) -> None:
    """A camera that a view can look through; one that stands still has one row."""
    lens = rr.Pinhole(fov_y=math.radians(FOV_DEG), aspect_ratio=ASPECT, camera_xyz=rr.ViewCoordinates.RDF, image_plane_distance=1e-3)
    clock.static(entity, lens)
    if len(shot.eye) == 1:
        clock.static(entity, rr.Transform3D(translation=shot.eye[0], mat3x3=shot.axes[0]))
    else:
        clock.send(entity, time_s, lambda k: rr.Transform3D.columns(translation=shot.eye[k], mat3x3=shot.axes[k]))


def alarm(clearance_m: Array) -> Array:
    """Colours (n, 4): red inside."""
    return np.where(inside(clearance_m)[:, None], rgba(palette.ALARM), rgba(palette.WHITE)).astype(np.uint8)


def _log_arrows(clock: Clock, view: str, film: Film, seconds: Array) -> None:
    """Wind, velocity through the air and over the ground, each as far as it goes in the same time; in calm air the velocity alone."""
    scale = seconds[:, None]
    if view == "close":
        log_arrow(clock, f"world/{view}/velocity", palette.OWN, film.time_s, film.own, scale * film.vel)
    if film.wind is None:
        return
    log_arrow(clock, f"world/{view}/wind", palette.AIR, film.time_s, film.own - scale * film.wind, scale * film.wind)
    if view == "close":
        log_arrow(clock, f"world/{view}/air_velocity", palette.AIR, film.time_s, film.own, scale * (film.vel - film.wind))


def _log_streaks(clock: Clock, film: Film, wind: Array, span_m: float) -> None:
    """Streaks of air round the aircraft."""
    rows = _slower(film.time_s, STREAK_HZ)
    tails, heads = np.moveaxis(airflow.streaks(film.time_s, film.own, wind, STREAK_BOX * span_m), 2, 0)[:, rows]
    clock.static("world/streaks", rr.Arrows3D.from_fields(colors=rgba(palette.AIR), radii=rr.Radius.ui_points(0.6)))

    def build(k: Array) -> rr.ComponentColumnList:
        origins, vectors = tails[k].reshape(-1, 3), (heads[k] - tails[k]).reshape(-1, 3)
        return rr.Arrows3D.columns(origins=origins, vectors=vectors).partition([airflow.COUNT] * len(k))

    clock.send("world/streaks", film.time_s[rows], build)


def _slower(time_s: Array, hz: float) -> Array:
    """Some of the rows: at least so long after one another; those that are farther apart all."""
    chosen, last = [], -np.inf
    for row, t in enumerate(time_s):
        if t - last > 1.0 / hz - TICK_S:
            chosen.append(row)
            last = t
    return np.array(chosen)


def _log_words(clock: Clock, record: FlightRecord, film: Film, name: str) -> None:
    """The clearance beside the aircraft, what the arrows and the sphere are, and from behind the bank and the load."""
    columns = record.columns
    rows = np.searchsorted(columns["time_s"], film.time_s - 1e-9)
    said, red = [words.clearance(metres, name) for metres in film.clearance_m], alarm(film.clearance_m)
    flown = [
        f"{words.bank(bank)}, {number(load, 1)} g\n{text}"
        for bank, load, text in zip(columns["own.bank_rad"][rows], columns["own.load_factor"][rows], said, strict=True)
    ]
    chased = [("own", film.own, np.array([0.0, 0.14]), flown, red)]
    towards, onwards = _directions(film)
    radius_m = next(spec.radius_m for spec in record.plan.obstacles if spec.name == name)
    surface = [f"surface of {name}, radius {number(radius_m, 0)} m"] * len(said)
    outwards = towards * np.where(film.clearance_m < 0.0, -1.0, 1.0)[:, None]
    near = [
        ("own", film.own, -ROOM * onwards, said, red),
        ("sphere", film.own + film.gap, ROOM * outwards, surface, shade(palette.LIGHT, len(said))),
    ]
    if film.wind is not None:
        wind = [words.wind(blows) for blows in film.wind]
        near += _airspeeds(film, film.wind, onwards, record.plan.speed_mps)
        for texts, shot in ((near, film.shots["close"]), (chased, film.shots["chase"])):
            tail = film.own - (ARROW * shot.height_m / record.plan.speed_mps)[:, None] * film.wind
            texts.append(("wind", tail, np.array([-0.16, 0.0]), wind, shade(palette.AIR, len(said))))
    for view, texts in (("close", near), ("chase", chased)):
        log_words(clock, f"world/{view}/words", film.time_s, film.shots[view], texts)


Text = tuple[str, Array, Array, list[str], Array]
"""A text's name, what it is about (n, 3), how far from that it shall be (n, 2) or (2,), and what it says and its colour by rows."""


def _airspeeds(film: Film, wind: Array, onwards: Array, speed_mps: float) -> list[Text]:
    """What the two arrows ahead are."""
    seconds = (ARROW * film.shots["close"].height_m / speed_mps)[:, None]
    return [
        (
            name,
            film.own + seconds * velocity,
            0.06 * onwards,
            [f"{what} {number(size, 1)} m/s" for size in sizes],
            shade(colour, len(sizes)),
        )
        for name, what, velocity, colour in (
            ("ground", "over the ground", film.vel, palette.OWN),
            ("air", "through the air", film.vel - wind, palette.AIR),
        )
        for sizes in [np.linalg.norm(velocity, axis=1)]
    ]


def _directions(film: Film) -> tuple[Array, Array]:
    """In the picture from near: towards the obstacle, and across to that, on the side to which the aircraft flies at its closest."""
    shot = film.shots["close"]
    towards = _in_picture(shot, film.gap * np.where(film.clearance_m < 0.0, -1.0, 1.0)[:, None])
    across = np.column_stack([-towards[:, 1], towards[:, 0]])
    closest = int(np.argmin(film.clearance_m))
    ahead = _in_picture(shot, film.vel)[closest]
    return towards, across if float(across[closest] @ ahead) >= 0.0 else -across


def log_words(clock: Clock, entity: str, time_s: Array, shot: Shot, texts: list[Text]) -> None:
    """Texts in the picture of a camera, none over another."""
    rows = _slower(time_s, WORDS_HZ)
    time_s, shot = time_s[rows], shot.some(rows)
    texts = [
        (name, about[rows], off if off.ndim == 1 else off[rows], [said[row] for row in rows], colours[rows])
        for name, about, off, said, colours in texts
    ]
    places = places_of(shot, texts, SHEET)
    for number_of, (name, _, _, said, colours) in enumerate(texts):
        log_label(clock, f"{entity}/{name}", time_s, shot.at(places[:, number_of]), said, colours)


def places_of(shot: Shot, texts: list[Text], sheet: labels.Sheet) -> Array:
    """Where the texts are in the picture (n, m, 2)."""
    wanted = np.stack([shot.seen(place) + off for _, place, off, _, _ in texts], axis=1)
    sizes = [sheet.sizes([said[k] for *_, said, _ in texts]) for k in range(len(wanted))]
    return np.array([labels.spread(sheet.within(row, size), size, sheet.edge[1]) for row, size in zip(wanted, sizes, strict=True)])


def shade(colour: str, rows: int) -> Array:
    """The same colour for every row (n, 4)."""
    return np.repeat(np.array([rgba(colour)], np.uint8), rows, axis=0)


def _in_picture(shot: Shot, vector: Array) -> Array:
    """Directions (n, 2) of vectors in the picture, right and up."""
    right, down = (np.einsum("ni,ni->n", vector, shot.axes[:, :, k]) for k in (0, 1))
    flat = np.column_stack([right, -down])
    return np.asarray(flat / np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-9))
