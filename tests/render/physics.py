# SPDX-License-Identifier: MIT
"""engine/SHADING.md in double precision, and pixels of an orthographic camera along -Z. Written from that text, not
from the engine: vectors are arrays whose last axis is x, y, z."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

HALF = 2.0**-11  # relative rounding of the half floats in a file
BLACK = ("--environment", "0,0,0")  # what rays that miss see


def dot(a: npt.ArrayLike, b: npt.ArrayLike) -> np.ndarray:
    return np.sum(np.asarray(a, float) * np.asarray(b, float), axis=-1)


def unit(v: npt.ArrayLike) -> np.ndarray:
    v = np.asarray(v, float)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def schlick(f0: npt.ArrayLike, x: npt.ArrayLike) -> np.ndarray:
    return np.asarray(f0, float) + (1 - np.asarray(f0, float)) * np.power(1 - np.asarray(x, float), 5)[..., None]


def f0_of(base: npt.ArrayLike, metallic: float = 0.0, ior: float = 1.5) -> np.ndarray:
    dielectric = ((ior - 1) / (ior + 1)) ** 2
    return dielectric * (1 - metallic) + np.asarray(base, float) * metallic


def mirror_share(roughness: float) -> float:
    return max(1 - roughness / 0.4, 0.0) ** 2


def fresnel(cosine: npt.ArrayLike, n1: float, n2: float) -> np.ndarray:
    """Unpolarised reflectance from n1 into n2, by the two Fresnel equations; 1 in total internal reflection."""
    cosine = np.asarray(cosine, float)
    sine = np.sqrt(np.maximum(0, 1 - cosine**2)) * n1 / n2
    inner = np.sqrt(np.maximum(0, 1 - sine**2))
    s = (n1 * cosine - n2 * inner) / (n1 * cosine + n2 * inner)
    p = (n2 * cosine - n1 * inner) / (n2 * cosine + n1 * inner)
    return np.where(sine >= 1, 1.0, (s * s + p * p) / 2)


def refract(direction: npt.ArrayLike, normal: npt.ArrayLike, n1: float, n2: float) -> np.ndarray:
    """Snell's law; the normal faces the ray."""
    direction, normal = unit(direction), unit(normal)
    cosine = -dot(direction, normal)[..., None]
    along = (direction + cosine * normal) * (n1 / n2)
    return along - np.sqrt(1 - dot(along, along))[..., None] * normal


def reflected(
    base: npt.ArrayLike,
    normal: npt.ArrayLike,
    view: npt.ArrayLike,
    towards: npt.ArrayLike,
    metallic: float = 0.0,
    roughness: float = 1.0,
    ior: float = 1.5,
    transmission: float = 0.0,
) -> np.ndarray:
    """f · (n·l): SHADING.md, step 6."""
    base, n, v, l = np.asarray(base, float), unit(normal), unit(view), unit(towards)  # noqa: E741
    nl, nv = dot(n, l), np.clip(dot(n, v), 1e-4, 1)
    h = unit(v + l)
    a2 = max(roughness, 0.1) ** 4
    d = a2 / (np.pi * (dot(n, h) ** 2 * (a2 - 1) + 1) ** 2)
    visibility = 0.5 / (nl * np.sqrt(nv**2 * (1 - a2) + a2) + nv * np.sqrt(nl**2 * (1 - a2) + a2))
    f = schlick(f0_of(base, metallic, ior), dot(v, h))
    r0 = ((ior - 1) / (ior + 1)) ** 2
    s = (1 - 0.6 * (max(roughness, 0.1) ** 2 - 0.01)) ** 3
    most = (1 - r0) * (1 - s * (1 - nv) ** 5) * (1 - s * np.clip(1 - nl, 0, 1) ** 5) / (1 - s / 21)
    diffuse = np.minimum(1 - f, most[..., None]) * (1 - metallic) * (1 - transmission) * base / np.pi
    return np.where((nl > 0)[..., None], (diffuse + f * (d * visibility)[..., None]) * nl[..., None], 0.0)


def ambient(
    base: npt.ArrayLike,
    normal: npt.ArrayLike,
    view: npt.ArrayLike,
    metallic: float = 0.0,
    roughness: float = 1.0,
    ior: float = 1.5,
    occlusion: float = 1.0,
) -> np.ndarray:
    """What a radiance of 1 from all around adds: SHADING.md, step 5."""
    nv = np.clip(dot(unit(normal), unit(view)), 1e-4, 1)
    gloss = (1 - mirror_share(roughness)) * schlick(f0_of(base, metallic, ior), nv)
    left = 1 - schlick(((ior - 1) / (ior + 1)) ** 2, nv)
    return ((1 - metallic) * left * np.asarray(base, float) + gloss) * occlusion


def pixels(
    width: int, height: int, xmag: float, ymag: float, centre: Sequence[float] = (0.0, 0.0)
) -> tuple[np.ndarray, np.ndarray]:
    """x and y in metres of every pixel's centre, for an orthographic camera along -Z."""
    x = ((np.arange(width) + 0.5) / width * 2 - 1) * xmag + centre[0]
    y = (1 - (np.arange(height) + 0.5) / height * 2) * ymag + centre[1]
    return np.broadcast_to(x, (height, width)).copy(), np.broadcast_to(y[:, None], (height, width)).copy()


def inside(x: npt.ArrayLike, y: npt.ArrayLike, triangles: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Which points lie in any of the flat triangles (n, 3, 2), and for which that is not a matter of rounding."""
    found, sure = np.zeros(np.shape(x), bool), np.ones(np.shape(x), bool)
    for corners in np.asarray(triangles, float)[..., :2]:
        edges = [
            ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / max(np.hypot(*(b - a)), 1e-30)
            for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)
        ]  # signed distances from the edges' lines
        least, most = np.minimum.reduce(edges), np.maximum.reduce(edges)
        within = (least >= 0) | (most <= 0)
        margin = np.maximum(least, -most)
        sure &= (np.abs(margin) > 1e-5) | found
        found |= within
        sure |= within & (margin > 1e-5)
    return found, sure


def box_of(x0: float, x1: float, y0: float, y1: float) -> list:
    """A rectangle as two triangles."""
    return [[(x0, y0), (x1, y0), (x1, y1)], [(x0, y0), (x1, y1), (x0, y1)]]


def close(found: npt.ArrayLike, wanted: npt.ArrayLike, relative: float = 2 * HALF, absolute: float = 1e-4) -> None:
    """Two half steps and a ten-thousandth, unless told otherwise: rounding in the file and float arithmetic."""
    np.testing.assert_allclose(
        np.asarray(found, float), np.broadcast_to(wanted, np.shape(found)), rtol=relative, atol=absolute
    )
