"""Solids for the items of a scene: plates, tubes and cylinders that lie in layers, as the links of a real mechanism."""

from collections.abc import Mapping

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from fmbd.model import Model
from fmbd.results.drawing import convex_hull
from fmbd.results.plots.mechanism import coil
from fmbd.results.scene import Item, Mesh

Plane = NDArray[np.complex128]

#: Corners of a full circle.
ROUND = 40
NOTCH = 0.1  # rad, of a wheel


def layers(model: Model) -> dict[str, int]:
    """A layer for each body, another one for bodies that a joint connects; the ground's is 0."""
    found = {"ground": 0}
    neighbours: dict[str, set[str]] = {name: set() for name in model.bodies}
    for joint in model.joints.values():
        one, other = (ref.body for ref in joint.between)
        for name, next_to in ((one, other), (other, one)):
            if name in neighbours:
                neighbours[name].add(next_to)
    for name, near in neighbours.items():
        taken = {found[each] for each in near if each in found and each != "ground"}
        found[name] = next(k for k in range(1, len(taken) + 2) if k not in taken)
    return found


def solid(item: Item, points: Plane, unit: float, layer: Mapping[str, int]) -> pv.PolyData:
    """The solid of an item at these points; `unit` is the size of symbols [m]."""
    low, high = heights(layer[item.body], unit)
    ends = sorted((layer[item.body], layer[item.other or item.body]))
    under, over = heights(ends[0], unit)[0] - 0.15 * unit, heights(ends[1], unit)[1] + 0.15 * unit
    match item.kind:
        case "body" | "shape" if item.mesh is not None:
            return placed(item.mesh, points, 0.5 * (low + high))
        case "body":
            return plate(around(points, 0.85 * unit), low, high)
        case "shape":
            return plate(points, low, high)
        case "wheel":
            return plate(notched(*points), low, high)
        case "beam":
            return tube(points, 0.5 * (low + high), 0.42 * unit)
        case "spring":
            return tube(coil(points, 1.2 * unit), over + 0.2 * unit, 0.16 * unit)
        case "block":
            return plate(points, low - 0.1 * unit, high + 0.1 * unit)
        case "rail":
            return plate(around(points, 0.18 * unit), -0.7 * unit, -0.3 * unit)
        case "pin":
            return plate(circle(points[0], 0.45 * unit), under, over)
        case "motor":
            shaft = plate(circle(points[0], 0.45 * unit), under, over)
            return plate(circle(points[0], 1.35 * unit), under - 1.5 * unit, under + 1.1 * unit) + shaft
        case "clamp":
            inward = (points[1] - points[0]) / abs(points[1] - points[0])
            corners = points[0] + inward * unit * np.array([-1.2 - 2.6j, -2.6j, 2.6j, -1.2 + 2.6j])
            return plate(corners, -2.0 * unit, 2.0 * unit + high)
    bracket = convex_hull(
        np.concatenate([circle(points[0], 0.9 * unit), points[0] + unit * np.array([-1.5 - 2j, 1.5 - 2j])])
    )
    foot = points[0] + unit * np.array([-2.6 - 2.5j, 2.6 - 2.5j, 2.6 - 2j, -2.6 - 2j])
    return plate(bracket, -0.6 * unit, 0.6 * unit) + plate(foot, -1.2 * unit, 1.2 * unit)


def heights(layer: int, unit: float) -> tuple[float, float]:
    """Where a layer begins and ends; that of the ground lies about zero."""
    return (1.1 * layer - 0.45) * unit, (1.1 * layer + 0.45) * unit


def circle(centre: complex, radius: float) -> Plane:
    """Corners of a circle."""
    return centre + radius * np.exp(2j * np.pi * np.arange(ROUND) / ROUND)


def notched(centre: complex, rim: complex) -> Plane:
    """A disc with a notch at a point of its rim, so that it is seen to turn."""
    edge = np.exp(1j * np.linspace(NOTCH, 2.0 * np.pi - NOTCH, 4 * ROUND))
    return centre + (rim - centre) * np.append(edge, 0.6)


def around(points: Plane, radius: float) -> Plane:
    """The convex outline at a distance around points."""
    return convex_hull(np.concatenate([circle(point, radius) for point in points]))


def plate(outline: Plane, low: float, high: float) -> pv.PolyData:
    """A flat solid between two heights."""
    corners = np.column_stack([outline.real, outline.imag, np.full(outline.size, low)])
    face = pv.PolyData(corners, faces=[outline.size, *range(outline.size)])
    return face.triangulate().extrude((0.0, 0.0, high - low), capping=True).clean()


def placed(mesh: Mesh, outline: Plane, height: float) -> pv.PolyData:
    """A mesh for looks, moved as its outline is."""
    faces = [number for face in mesh.visual.faces for number in (len(face), *face)]
    solid = pv.PolyData(np.array(mesh.visual.points), faces=faces)
    solid.transform(moved(mesh.outline, outline), inplace=True)
    solid.points[:, 2] += height
    return solid


def tube(points: Plane, height: float, radius: float) -> pv.PolyData:
    """A round bar along a curve."""
    corners = np.column_stack([points.real, points.imag, np.full(points.size, height)])
    return pv.PolyData(corners, lines=[points.size, *range(points.size)]).tube(
        radius=radius, n_sides=20, capping=True
    )


def moved(first: Plane, now: Plane) -> NDArray[np.float64]:
    """The matrix (4, 4) that takes a rigid item from its first points to those of another time."""
    turn = 1.0 + 0j
    if first.size > 1 and abs(first[1] - first[0]) > 0.0:
        turn = (now[1] - now[0]) / (first[1] - first[0])
        turn /= abs(turn)
    shift = now[0] - turn * first[0]
    matrix = np.eye(4)
    matrix[:2, :2] = [[turn.real, -turn.imag], [turn.imag, turn.real]]
    matrix[:2, 3] = shift.real, shift.imag
    return matrix
