// SPDX-License-Identifier: BSD-3-Clause
// What hides a point from where the camera might stand.
import { Ray, Vector3 } from 'three';

/** A body that may stand in the way of a line of sight. */
export class Occluder {
  /**
   * geometry: a BufferGeometry in the frame of the body; off: how far it may be from the body's
   * surface, m.
   */
  constructor(geometry, off) {
    const { position } = geometry.attributes,
      { index } = geometry,
      count = index?.count ?? position.count,
      [a, b, c] = Array.from({ length: 3 }, () => new Vector3());
    geometry.computeBoundingBox();
    Object.assign(this, { off, box: geometry.boundingBox });
    const corner = (k, into) => into.fromBufferAttribute(position, index ? index.getX(k) : k);
    // Of each triangle a corner and the two edges from it, nine numbers.
    this.triangles = new Float64Array(3 * count);
    for (let k = 0; k < count; k += 3) {
      corner(k, a);
      corner(k + 1, b).sub(a);
      corner(k + 2, c).sub(a);
      this.triangles.set([...a, ...b, ...c], 3 * k);
    }
  }
  /** ray: a Ray in the frame of the body; far: how far along it something may be hidden, m. */
  hides(ray, far) {
    const entry = ray.intersectBox(this.box, new Vector3());
    if (!entry) return false;
    const isInside = this.box.containsPoint(ray.origin);
    if (!isInside && entry.distanceTo(ray.origin) > far) return false;
    return this.isHit(ray, far - this.off);
  }
  /** Moeller and Trumbore's intersection with any of the triangles. */
  isHit({ origin: o, direction: d }, far) {
    const t = this.triangles;
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
}

/** Bodies in a pose, and whether one of them hides a point. */
export class Sight {
  /** bodies: [{ occluder, pose (Matrix4) }]. */
  constructor(bodies) {
    this.bodies = bodies.map((body) => ({ ...body, inverse: body.pose.clone().invert() }));
    this.ray = new Ray();
  }
  /**
   * Whether a body stands between two points. What lies within 1 cm of `to` does not count; nor
   * does body number `own`.
   */
  hides(from, to, own = -1) {
    const direction = to.clone().sub(from),
      far = direction.length() - 0.01;
    direction.normalize();
    return this.bodies.some(({ occluder, inverse }, k) => {
      if (k === own) return false;
      this.ray.set(from, direction).applyMatrix4(inverse);
      return occluder.hides(this.ray, far);
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
