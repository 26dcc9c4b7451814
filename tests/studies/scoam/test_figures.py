"""The paper's figures: all fourteen, their numbers those of the library, the same in every form."""

import csv
import io
import math
import subprocess
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from testbed.show.drawing import Arrow, Body, Dot, Line, Sphere
from testbed.show.svg_picture import HEIGHT, WIDTH, svg
from testbed.studies.scoam.figures.encounters import figures
from testbed.studies.scoam.figures.write import values_csv, write_figures
from tests.show.test_recording import RERUN, entities
from vosc import Obstacle, Own, cap, insertion_point, ph, threat
from vosc.direction import cap_gap, corner_points
from vosc.methods import avoid
from vosc.spherical_cap import generatrices

DEG = math.pi / 180.0


def vector(size, azimuth, elevation):
    flat = size * math.cos(elevation * DEG)
    return (flat * math.cos(azimuth * DEG), flat * math.sin(azimuth * DEG), size * math.sin(elevation * DEG))


OWN = Own((162, 101, 64.3), vector(50, 24.7, 12.0))
ONE = Obstacle((254, 63.6, 60.7), vector(40, 106, 12.4), 25)  # in the reading in which it is a threat
FIRST = Obstacle((254, 63.8, 59.8), vector(35, 106, 11.4), 25)
SECOND = Obstacle((208, 186, 42.5), vector(32, -50.3, 15.4), 30)  # climbing, the same


def values(number):
    (picture,) = [picture for picture in figures() if picture.number == number]
    return {value.sign: value.value for value in picture.values}


def angles(v):
    return math.atan2(v[1], v[0]) / DEG, math.asin(v[2] / np.linalg.norm(v)) / DEG


def test_all_fourteen_are_there_and_none_has_an_unknown_number():
    assert [picture.number for picture in figures()] == list(range(1, 15))
    for picture in figures():
        assert picture.values
        assert picture.note
        for value in picture.values:
            assert np.isfinite(value.value).all(), (picture.number, value)


def test_cone_threat_and_cap_are_the_librarys():
    found, g = threat(OWN, ONE), cap(OWN, ONE)
    for number in (1, 10):
        shown = values(number)
        assert shown["d_0"] == pytest.approx(found.distance_m)
        assert shown["\N{GREEK SMALL LETTER ALPHA}_0"] * DEG == pytest.approx(found.alpha0_rad)
        assert shown["\N{GREEK SMALL LETTER ALPHA}"] * DEG == pytest.approx(found.alpha_rad)
        assert shown["d"] == pytest.approx(found.miss_m)
    shown = values(4)
    assert [shown[sign] for sign in ("r", "\N{GREEK SMALL LETTER GAMMA}")] == pytest.approx([g.radius_mps, g.half_angle_rad / DEG])
    assert shown["r / cos \N{GREEK SMALL LETTER GAMMA}"] == pytest.approx(50.0)
    gap = cap_gap(OWN, ONE)
    assert [values(3)["out"], values(3)["in"]] == pytest.approx([gap.max() / DEG, -gap.min() / DEG])


def test_turn_and_triangle_are_the_librarys():
    g, (near, _) = cap(OWN, ONE), generatrices(OWN, ONE)
    shown = values(5)
    answer = avoid("scoam", OWN, [ONE])
    assert shown["turn"] == pytest.approx(answer.deflection_rad / DEG)
    assert shown["v\N{COMBINING CIRCUMFLEX ACCENT}_u"] == pytest.approx(angles(answer.velocity_mps))
    assert shown["\N{GREEK SMALL LETTER LAMDA}"] == pytest.approx(np.dot(g.nearest_mps - np.array(ONE.vel_mps), near))
    shown = values(6)
    assert shown["|BC|"] == pytest.approx(np.linalg.norm(g.nearest_mps - g.farthest_mps))
    assert shown["r"] == pytest.approx(g.radius_mps)


def test_two_caps_corners_and_the_chosen_point_are_the_librarys():
    caps, shown = [cap(OWN, one) for one in (FIRST, SECOND)], values(7)
    for number, found in enumerate(caps, 1):
        assert shown[f"r_{number}"] == pytest.approx(found.radius_mps)
    for sign, place in zip(("S", "S\N{PRIME}"), corner_points(*caps, 50.0), strict=True):
        assert shown[sign] == pytest.approx(angles(place))
    chosen = avoid("scoam", OWN, [FIRST, SECOND]).velocity_mps
    assert shown["K"] == pytest.approx(np.array(OWN.pos_m) + chosen)
    given = np.array(shown["K(y_k)"]) - OWN.pos_m
    assert given[1] == pytest.approx(0.0)  # the printed y_k is that of P_t
    assert np.linalg.norm(given) == pytest.approx(50.0)
    assert min(abs(given @ (middle := 0.5 * (g.nearest_mps + g.farthest_mps)) - middle @ middle) for g in caps) == pytest.approx(
        0.0, abs=1e-6
    )


@pytest.mark.parametrize(("number", "bodies"), [(11, [ONE]), (14, [FIRST, SECOND])])
def test_paths_go_through_the_librarys_insertion_point(number, bodies):
    shown, point = values(number), insertion_point(OWN, bodies[0], 1.25).point_m
    assert shown["Q_avo"] == pytest.approx(point)
    chosen = avoid("scoam", OWN, bodies).velocity_mps / 50.0
    chord = np.linalg.norm(point - OWN.pos_m)
    leg = ph.hermite(OWN.pos_m, chord * np.array(OWN.vel_mps) / 50.0, point, chord * chosen)
    assert shown["t"] == pytest.approx(leg.length_m / 50.0)
    assert shown["R_min"] == pytest.approx(1.0 / leg.max_curvature(), rel=1e-6)


def test_the_original_path_is_the_one_that_is_flown():
    start, goal = np.zeros(3), np.array([500.0, 200.0, 100.0])
    chord = np.linalg.norm(goal)
    curve = ph.hermite(start, chord * np.array(vector(1, 40.87, 26.13)), goal, chord * np.array(vector(1, 10.0, 2.84)))
    assert values(8)["L"] == pytest.approx(curve.length_m)
    (line,) = [thing for picture in figures() if picture.number == 8 for thing in picture.things if isinstance(thing, Line)]
    assert line.points == pytest.approx(curve.points(np.linspace(0.0, curve.length_m, len(line.points))))


def test_a_figure_is_drawn_to_scale_and_holds_its_numbers():
    """A sphere's radius over the length of a velocity, both in the plane of the picture, is that of the encounter."""
    picture = figures()[2]
    drawn = ET.fromstring(svg(picture))
    assert (drawn.get("width"), drawn.get("height")) == (str(WIDTH), str(HEIGHT))
    circle = next(drawn.iter("{http://www.w3.org/2000/svg}circle"))
    shafts = [thing for thing in picture.things if isinstance(thing, Arrow)]
    (sphere,) = [thing for thing in picture.things if isinstance(thing, Sphere)]
    assert np.linalg.norm(shafts[0].vector) == pytest.approx(sphere.radius)  # v_u ends on VS
    heads = [shape for shape in drawn.iter("{http://www.w3.org/2000/svg}polygon") if shape.get("fill") == "#0B5FA5"]
    tip = np.array([float(x) for x in heads[0].get("points").split()[0].split(",")])
    centre = np.array([float(circle.get("cx")), float(circle.get("cy"))])
    towards = np.array(picture.towards) / np.linalg.norm(picture.towards)
    across = np.linalg.norm(shafts[0].vector - (shafts[0].vector @ towards) * towards)
    assert np.linalg.norm(tip - centre) / float(circle.get("r")) == pytest.approx(across / sphere.radius, abs=2e-3)
    text = "".join(drawn.itertext())
    for value in picture.values:
        assert value.text in text


def test_everything_is_inside_its_frame_and_the_same_twice():
    for picture in figures():
        text = svg(picture)
        assert text == svg(picture)
        if picture.larger is None:  # else what is shown larger is cut off at its frame
            for words in ET.fromstring(text).iter("{http://www.w3.org/2000/svg}text"):
                assert 0.0 <= float(words.get("x")) <= WIDTH
                assert 0.0 <= float(words.get("y")) <= HEIGHT, (picture.number, "".join(words.itertext()))


@pytest.mark.slow
def test_the_files_hold_the_same_numbers_and_the_recording_everything_that_is_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr("testbed.studies.scoam.figures.write.BROWSERS", ())
    names = {path.name for path in write_figures(tmp_path)}
    assert names == {f"figure_{number:02d}.svg" for number in range(1, 15)} | {"values.csv", "figures.rrd"}
    rows = list(csv.DictReader(io.StringIO((tmp_path / "values.csv").read_text())))
    assert (tmp_path / "values.csv").read_text() == values_csv(figures())
    assert len(rows) == sum(len(picture.values) for picture in figures())
    cell = next(row for row in rows if (row["figure"], row["sign"]) == ("11", "Q_avo"))
    assert [float(part) for part in cell["value"].split()] == pytest.approx(insertion_point(OWN, ONE, 1.25).point_m)
    assert cell["printed"] == "(226.34, 159.56, 79.05)"
    found = subprocess.run([str(RERUN), "rrd", "verify", str(tmp_path / "figures.rrd")], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
    there = entities(tmp_path / "figures.rrd")
    for picture in figures():
        assert f"/values/figure_{picture.number:02d}" in there
        drawn = {entity for entity in there if entity.startswith(f"/figure_{picture.number:02d}/")}
        assert len(drawn) == len(picture.things)
        assert any(isinstance(thing, Body | Dot | Line) for thing in picture.things)


@pytest.mark.slow
@pytest.mark.browser
def test_the_browser_draws_each_figure_by_itself(tmp_path):
    from PIL import Image

    from testbed.studies.scoam.figures.write import SCALE, _pictured, browser

    if browser() is None:
        pytest.skip("no chromium (Debian: chromium)")
    files = []
    for picture in figures()[:2]:
        file = tmp_path / f"figure_{picture.number:02d}.svg"
        file.write_text(svg(picture))
        files.append(file)
    first, second = (Image.open(path) for path in _pictured(files))
    assert first.size == second.size == (round(WIDTH * SCALE), round(HEIGHT * SCALE))
    assert first.tobytes() != second.tobytes()
    for image in (first, second):
        assert image.convert("L").getextrema()[0] < 100  # something is drawn
        assert image.convert("RGB").crop((0, 0, image.width, 8)).getextrema() == ((255, 255),) * 3  # and it was cut at its edge
