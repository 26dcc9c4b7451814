"""Small meshes and line sets, in the axes of the thing they show. Geometry only: who draws them decides where and when."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Mesh:
    """Triangles: ``points`` (n, 3), ``triangles`` (m, 3) indices into them, ``normals`` (n, 3)."""

    points: Array
    triangles: Array
    normals: Array


def _flat_shaded(faces: list[list[tuple[float, float, float]]]) -> Mesh:
    """A mesh of convex polygons with sharp edges: every face has vertices of its own."""
    points: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    normals: list[Array] = []
    for face in faces:
        first = len(points)
        a, b, c = (np.array(corner) for corner in face[:3])
        normal = np.cross(b - a, c - a)
        normal = normal / np.linalg.norm(normal)
        points.extend(face)
        normals.extend([normal] * len(face))
        triangles.extend((first, first + k, first + k + 1) for k in range(1, len(face) - 1))
    return Mesh(np.array(points), np.array(triangles, np.uint32), np.array(normals))


def _slab(outline: list[tuple[float, float]], thickness: float, vertical: bool) -> list[list[tuple[float, float, float]]]:
    """A thin plate: a wing (outline in x, y) or a fin (outline in x, z)."""
    half = thickness / 2

    def corner(xy: tuple[float, float], offset: float) -> tuple[float, float, float]:
        return (xy[0], offset, xy[1]) if vertical else (xy[0], xy[1], offset)

    upper, lower = ([corner(xy, side) for xy in outline] for side in (-half, half))
    n = len(outline)
    return [upper, lower[::-1], *([upper[k], lower[k], lower[(k + 1) % n], upper[(k + 1) % n]] for k in range(n))]


def aeroplane(length_m: float) -> Mesh:
    """A plain fixed-wing outline in body axes (x forward, y right, z down), its nose at +x, about as wide as long."""
    ring = [(math.cos(a), math.sin(a)) for a in np.arange(8) * math.pi / 4]
    stations = [(0.50, 0.012), (0.40, 0.050), (0.10, 0.062), (-0.25, 0.040), (-0.50, 0.012)]  # x, radius in lengths
    hoops = [[(x, r * c, r * s) for c, s in ring] for x, r in stations]
    faces = [[fore[k], fore[(k + 1) % 8], aft[(k + 1) % 8], aft[k]] for fore, aft in pairwise(hoops) for k in range(8)]
    faces += _slab([(0.14, 0.0), (0.02, 0.52), (-0.07, 0.52), (-0.06, 0.0), (-0.07, -0.52), (0.02, -0.52)], 0.016, vertical=False)
    faces += _slab([(-0.36, 0.0), (-0.43, 0.20), (-0.49, 0.20), (-0.48, 0.0), (-0.49, -0.20), (-0.43, -0.20)], 0.012, vertical=False)
    faces += _slab([(-0.34, -0.02), (-0.44, -0.20), (-0.50, -0.20), (-0.49, -0.02)], 0.012, vertical=True)
    mesh = _flat_shaded(faces)
    return Mesh(mesh.points * length_m, mesh.triangles, mesh.normals)


SPAN_OF_LENGTH = 1.04
"""Wing span of ``aeroplane`` in its lengths."""


def circles(half_angle_rad: Array, around: int = 48) -> Array:
    """Closed circles (n, around + 1, 3) on the unit sphere, one for each angle from +x."""
    angle = np.arange(around + 1) * (2 * math.pi / around)
    flat, spread = np.cos(half_angle_rad)[:, None], np.sin(half_angle_rad)[:, None]
    return np.stack([np.broadcast_to(flat, (len(flat), around + 1)), spread * np.cos(angle), spread * np.sin(angle)], axis=2)


def cone_triangles(around: int = 48) -> Array:
    """The side of a cone whose apex is point 0 and whose rim are the ``around`` points after it."""
    index = np.arange(around)
    return np.column_stack([np.zeros(around), 1 + index, 1 + (index + 1) % around]).astype(np.uint32)


def caps(half_angle_rad: Array, rings: int = 5, around: int = 32) -> Array:
    """Points (n, 1 + rings * around, 3) of the part of the unit sphere within each angle of +x."""
    parts = [np.broadcast_to([1.0, 0.0, 0.0], (len(half_angle_rad), 1, 3))]
    parts += [circles(half_angle_rad * (ring / rings), around)[:, :-1] for ring in range(1, rings + 1)]
    return np.concatenate(parts, axis=1)


def cap_triangles(rings: int = 5, around: int = 32) -> Array:
    """The surface between the points of one of ``caps``."""
    index = np.arange(around)
    following = (index + 1) % around
    triangles = [np.column_stack([np.zeros(around), 1 + index, 1 + following])]
    for ring in range(rings - 1):
        inner, outer = 1 + ring * around, 1 + (ring + 1) * around
        triangles.append(np.column_stack([inner + index, outer + index, outer + following]))
        triangles.append(np.column_stack([inner + index, outer + following, inner + following]))
    return np.vstack(triangles).astype(np.uint32)


def graticule(step_deg: float = 30.0) -> list[Array]:
    """Meridians and parallels of the unit sphere, as closed or open lines."""
    along = np.radians(np.arange(-90.0, 90.1, 5.0))
    around = np.radians(np.arange(0.0, 360.1, 5.0))
    meridians = [
        np.column_stack([np.cos(along) * math.cos(a), np.cos(along) * math.sin(a), np.sin(along)])
        for a in np.radians(np.arange(0.0, 360.0, step_deg))
    ]
    parallels = [
        np.column_stack([math.cos(e) * np.cos(around), math.cos(e) * np.sin(around), np.full(len(around), math.sin(e))])
        for e in np.radians(np.arange(-90.0 + step_deg, 90.0, step_deg))
    ]
    return meridians + parallels


def turned_from_x_axis(points: Array, axis: Array) -> Array:
    """Each of n sets of points (n, m, 3) turned, by the shortest way, so that +x becomes its ``axis`` (n, 3)."""
    unit = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    x, y, z = unit[:, 0], unit[:, 1], unit[:, 2]
    # Rodrigues' formula for the rotation about (+x cross unit); exactly backwards has no shortest way, so turn about z.
    backwards = x < -1.0 + 1e-12
    share = 1.0 / np.where(backwards, 1.0, 1.0 + x)
    zero = np.zeros_like(x)
    columns = [
        unit,
        np.stack([-y, 1.0 - y * y * share, -y * z * share], axis=1),
        np.stack([-z, -y * z * share, 1.0 - z * z * share], axis=1),
    ]
    columns[1] = np.where(backwards[:, None], np.stack([zero, zero - 1.0, zero], axis=1), columns[1])
    columns[2] = np.where(backwards[:, None], np.stack([zero, zero, zero + 1.0], axis=1), columns[2])
    turned: Array = np.einsum("nij,nmj->nmi", np.stack(columns, axis=2), points)
    return turned
