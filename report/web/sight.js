// SPDX-License-Identifier: BSD-3-Clause
// What hides a point from where the camera might stand.
import { Ray, Vector3 } from 'three';

/** Calls back with the corners a, b, c of each triangle of a geometry; the vectors are reused. */
function forTriangles({ attributes: { position }, index }, each) {
  const count = index?.count ?? position.count,
    [a, b, c] = Array.from({ length: 3 }, () => new Vector3());
  const corner = (k, into) => into.fromBufferAttribute(position, index ? index.getX(k) : k);
  for (let k = 0; k < count; k += 3) each(corner(k, a), corner(k + 1, b), corner(k + 2, c));
}
/** Of each triangle a corner and the two edges from it, nine numbers. */
const nine = (a, b, c) => [...a, b.x - a.x, b.y - a.y, b.z - a.z, c.x - a.x, c.y - a.y, c.z - a.z];

/** Whether a ray meets one of the triangles nearer than `far`: Moeller and Trumbore's test. */
function isHit(t, { origin: o, direction: d }, far) {
  for (let k = 0; k < t.length; k += 9) {
    const bx = t[k + 3],
      by = t[k + 4],
      bz = t[k + 5],
      cx = t[k + 6],
      cy = t[k + 7],
      cz = t[k + 8],
      px = d.y * cz - d.z * cy,
      py = d.z * cx - d.x * cz,
      pz = d.x * cy - d.y * cx,
      det = bx * px + by * py + bz * pz;
    if (Math.abs(det) < 1e-14) continue;
    const ox = o.x - t[k],
      oy = o.y - t[k + 1],
      oz = o.z - t[k + 2],
      u = (ox * px + oy * py + oz * pz) / det;
    if (u < 0 || u > 1) continue;
    const qx = oy * bz - oz * by,
      qy = oz * bx - ox * bz,
      qz = ox * by - oy * bx,
      v = (d.x * qx + d.y * qy + d.z * qz) / det;
    if (v < 0 || u + v > 1) continue;
    const way = (cx * qx + cy * qy + cz * qz) / det;
    if (way > 0 && way < far) return true;
  }
  return false;
}

const kSlack = 0.015; // what lies as near to a point does not hide it, m

/** A body that may stand in the way of a line of sight. */
export class Occluder {
  /**
   * coarse: a BufferGeometry in the frame of the body, with few triangles; off: how far it may be
   * from the body's surface, m; fine: the surface itself.
   */
  constructor(coarse, off, fine) {
    coarse.computeBoundingBox();
    Object.assign(this, { off, fine, box: coarse.boundingBox });
    const triangles = [];
    forTriangles(coarse, (a, b, c) => triangles.push(...nine(a, b, c)));
    this.triangles = new Float64Array(triangles);
  }
  /** The triangles of the surface so near to a point that `coarse` does not tell what hides it. */
  near(point) {
    const reach = this.off + kSlack,
      triangles = [];
    if (this.off === 0 || this.box.distanceToPoint(point) > reach + this.off) return triangles;
    const apart = (axis, a, b, c) => {
      const [x, p, q, r] = [point[axis], a[axis], b[axis], c[axis]];
      return Math.min(p, q, r) > x + reach || Math.max(p, q, r) < x - reach;
    };
    forTriangles(this.fine, (a, b, c) => {
      if (apart('x', a, b, c) || apart('y', a, b, c) || apart('z', a, b, c)) return;
      triangles.push(...nine(a, b, c));
    });
    return triangles;
  }
  /**
   * ray: a Ray in the frame of the body; far: how far along it something may be hidden, m; near: of
   * what may be hidden.
   */
  hides(ray, far, near) {
    const entry = ray.intersectBox(this.box, new Vector3()),
      isInside = this.box.containsPoint(ray.origin),
      isBefore = entry && (isInside || entry.distanceTo(ray.origin) <= far);
    return (isBefore && isHit(this.triangles, ray, far - this.off)) || isHit(near, ray, far);
  }
}

/** Bodies in a pose, and whether one of them hides a point. */
export class Sight {
  /** bodies: [{ occluder, pose (Matrix4) }]. */
  constructor(bodies) {
    this.bodies = bodies.map((body) => ({
      ...body,
      inverse: body.pose.clone().invert(),
      near: new Map(), // of the points that were asked about
    }));
    this.ray = new Ray();
  }
  /**
   * Whether a body stands between two points. What lies within 15 mm of `to` does not count; nor
   * does body number `own`.
   */
  hides(from, to, own = -1) {
    const direction = to.clone().sub(from),
      far = direction.length() - kSlack;
    direction.normalize();
    return this.bodies.some(({ occluder, inverse, near }, k) => {
      if (k === own) return false;
      if (!near.has(to)) near.set(to, occluder.near(to.clone().applyMatrix4(inverse)));
      this.ray.set(from, direction).applyMatrix4(inverse);
      return occluder.hides(this.ray, far, near.get(to));
    });
  }
}

/** The eight corners of a box in a pose. */
export const cornersOf = ({ min, max }, pose) =>
  Array.from({ length: 8 }, (_, k) =>
    new Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z).applyMatrix4(
      pose,
    ),
  );
