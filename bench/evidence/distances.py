# SPDX-License-Identifier: BSD-3-Clause
"""Distances from line segments, the cores of capsules, to other shapes. Arrays of shape (N, 3),
metres; results (N,)."""
import numpy as np


def segment_segment(a, b, c, d):
    """From a-b to c-d; Ericson, Real-Time Collision Detection, 5.1.9."""
    u, v, w = b - a, d - c, a - c
    uu, vv, uv = (u * u).sum(-1), (v * v).sum(-1), (u * v).sum(-1)
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    tiny = 1e-30
    denominator = uu * vv - uv * uv
    s = np.where(
        denominator > 1e-12 * uu * vv + tiny,
        np.clip((uv * vw - uw * vv) / np.maximum(denominator, tiny), 0, 1), 0
    )
    t = np.clip((uv * s + vw) / np.maximum(vv, tiny), 0, 1)
    s = np.where(uu > tiny, np.clip((uv * t - uw) / np.maximum(uu, tiny), 0, 1), 0)
    apart = w + s[..., None] * u - t[..., None] * v
    # Parallel segments: the closest points may lie at any end.
    best = (apart * apart).sum(-1)
    for end, other in ((a, (c, v, vv)), (b, (c, v, vv)), (c, (a, u, uu)), (d, (a, u, uu))):
        start, way, length = other
        at = np.clip(((end - start) * way).sum(-1) / np.maximum(length, tiny), 0, 1)
        apart = end - start - at[..., None] * way
        best = np.minimum(best, (apart * apart).sum(-1))
    return np.sqrt(best)


def point_box(p, half):
    """To a solid box about the origin."""
    return np.linalg.norm(np.maximum(np.abs(p) - half, 0), axis=-1)


def point_cylinder(p, radius, half):
    """To a solid cylinder with flat ends about the origin, along z."""
    return np.hypot(
        np.maximum(np.hypot(p[..., 0], p[..., 1]) - radius, 0),
        np.maximum(np.abs(p[..., 2]) - half, 0),
    )


def segment_convex(a, b, distance):
    """Least of a convex function of points along a-b, by golden section to 1e-10 of the length."""
    golden = (np.sqrt(5) - 1) / 2
    low, high = np.zeros(len(a)), np.ones(len(a))
    at = lambda t: distance(a + t[:, None] * (b - a))
    x, y = high - golden, low + golden
    fx, fy = at(x), at(y)
    best = np.minimum(np.minimum(fx, fy), np.minimum(at(low), at(high)))
    for _ in range(48):
        left = fx < fy
        low, high = np.where(left, low, x), np.where(left, y, high)
        x, y, kept = (
            high - golden * (high - low), low + golden * (high - low), np.where(left, fx, fy)
        )
        fresh = at(np.where(left, x, y))
        fx, fy = np.where(left, fresh, kept), np.where(left, kept, fresh)
        best = np.minimum(best, fresh)
    return best


def segment_triangle(a, b, triangle):
    """triangle: (N, 3, 3). Zero where the segment passes through."""
    p, q, r = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    best = np.minimum(
        segment_segment(a, b, p, q),
        np.minimum(segment_segment(a, b, q, r), segment_segment(a, b, r, p)),
    )
    normal = np.cross(q - p, r - p)
    size = np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-30)
    normal = normal / size

    def inside(x):
        """Whether points lie over the triangle, along its normal."""
        return np.all(
            [
                (np.cross(side, x - corner) * normal).sum(-1) >= 0
                for corner, side in ((p, q - p), (q, r - q), (r, p - r))
            ],
            axis=0,
        )

    heights = [((end - p) * normal).sum(-1) for end in (a, b)]
    for end, height in zip((a, b), heights):
        best = np.where(inside(end), np.minimum(best, np.abs(height)), best)
    span = heights[0] - heights[1]
    t = np.clip(heights[0] / np.where(np.abs(span) > 1e-30, span, 1), 0, 1)
    through = (
        (heights[0] * heights[1] <= 0) & (np.abs(span) > 1e-30) & inside(a + t[:, None] * (b - a))
    )
    return np.where(through, 0, best)


class Mesh:
    """A closed surface of triangles (T, 3, 3)."""

    def __init__(self, triangles):
        self.triangles = triangles
        self.centres = triangles.mean(1)
        self.radii = np.linalg.norm(triangles - self.centres[:, None], axis=-1).max(1)

    def distance(self, a, b):
        """From segments; triangles whose bounding spheres are too far to count are left out."""
        result = np.empty(len(a))
        for n in range(len(a)):
            way = b[n] - a[n]
            t = np.clip((self.centres - a[n]) @ way / max(way @ way, 1e-30), 0, 1)
            to_centre = np.linalg.norm(a[n] + t[:, None] * way - self.centres, axis=-1)
            near = self.triangles[to_centre - self.radii <= (to_centre + self.radii).min()]
            result[n] = segment_triangle(
                np.broadcast_to(a[n], (len(near), 3)), np.broadcast_to(b[n], (len(near), 3)), near
            ).min()
        return result

    def contains(self, p):
        """Whether a point lies inside: the solid angle of all triangles is 4 pi there, 0 outside
        (Van Oosterom and Strackee)."""
        x, y, z = np.moveaxis(self.triangles - p, 1, 0)
        lx, ly, lz = (np.linalg.norm(v, axis=-1) for v in (x, y, z))
        product = (x * np.cross(y, z)).sum(-1)
        below = lx * ly * lz + (x * y).sum(-1) * lz + (y * z).sum(-1) * lx + (z * x).sum(-1) * ly
        return abs(2 * np.arctan2(product, below).sum()) > 2 * np.pi
