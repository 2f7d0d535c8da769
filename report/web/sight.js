// SPDX-License-Identifier: BSD-3-Clause
// What hides a point from where the camera might stand.
import { Box3, Ray, Vector3 } from 'three';

const kFew = 6000, // triangles that are asked one by one
  kCells = 64; // along the longest edge of a grid in place of more

/**
 * A body that may stand in the way of a line of sight. A heavy mesh is replaced by the cells of a
 * grid through which its triangles pass: a ray against each triangle would take seconds.
 */
export class Occluder {
  /** geometry: a BufferGeometry in the frame of the body. */
  constructor(geometry) {
    const { position } = geometry.attributes,
      { index } = geometry;
    geometry.computeBoundingBox();
    this.box = geometry.boundingBox;
    this.corners = (index?.count ?? position.count) - ((index?.count ?? position.count) % 3);
    this.corner = (k, into) => into.fromBufferAttribute(position, index ? index.getX(k) : k);
    if (this.corners > 3 * kFew) this.fillGrid();
    else this.listTriangles();
  }
  fillGrid() {
    const size = this.box.getSize(new Vector3());
    this.cell = Math.max(size.x, size.y, size.z) / kCells || 1;
    this.counts = size.toArray().map((length) => Math.floor(length / this.cell) + 1);
    this.grid = new Uint8Array(this.counts[0] * this.counts[1] * this.counts[2]);
    const [a, b, c, at] = Array.from({ length: 4 }, () => new Vector3());
    for (let k = 0; k < this.corners; k += 3) {
      this.corner(k, a);
      this.corner(k + 1, b).sub(a);
      this.corner(k + 2, c).sub(a);
      const n = Math.ceil(Math.max(b.length(), c.length(), b.distanceTo(c)) / this.cell);
      for (let i = 0; i <= n; ++i)
        for (let j = 0; i + j <= n; ++j)
          this.grid[
            this.cellAt(at.copy(a).addScaledVector(b, i / n).addScaledVector(c, j / n))
          ] = 1;
    }
  }
  /** The number of the cell that holds a point, or of the nearest one. */
  cellAt(point) {
    const at = (k) => {
      const place = (point.getComponent(k) - this.box.min.getComponent(k)) / this.cell;
      return Math.min(this.counts[k] - 1, Math.max(0, Math.floor(place)));
    };
    return (at(0) * this.counts[1] + at(1)) * this.counts[2] + at(2);
  }
  /** ray: a Ray in the frame of the body; far: how far along it something may be hidden, m. */
  hides(ray, far) {
    const entry = ray.intersectBox(this.box, new Vector3());
    if (!entry) return false;
    const from = this.box.containsPoint(ray.origin) ? 0 : entry.distanceTo(ray.origin);
    if (from > far) return false;
    return this.grid ? this.marches(ray, from, far) : this.isHit(ray, far);
  }
  /** Of each triangle a corner and the two edges from it, nine numbers. */
  listTriangles() {
    const [a, b, c] = Array.from({ length: 3 }, () => new Vector3());
    this.triangles = new Float64Array(3 * this.corners);
    for (let k = 0; k < this.corners; k += 3) {
      this.corner(k, a);
      this.corner(k + 1, b).sub(a);
      this.corner(k + 2, c).sub(a);
      this.triangles.set([...a, ...b, ...c], 3 * k);
    }
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
  /** From where the ray enters the box to two cells before its end, which may lie on the body. */
  marches(ray, from, far) {
    const at = new Vector3(),
      end = Math.min(far - 2 * this.cell, from + this.box.getSize(at).length());
    for (let way = from; way < end; way += this.cell / 2) {
      ray.at(way, at);
      if (way > from + this.cell && !this.box.containsPoint(at)) return false;
      if (this.grid[this.cellAt(at)]) return true;
    }
    return false;
  }
}

/** Bodies in a pose, and whether one of them hides a point. */
export class Sight {
  /** bodies: [{ occluder, pose (Matrix4), ...}]. */
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

/** The box of a geometry's corners in a pose, tighter than that of its box. */
export const boxIn = (geometry, pose) => {
  geometry.computeBoundingBox();
  return new Box3().setFromPoints(cornersOf(geometry.boundingBox, pose));
};
/** The eight corners of a box in a pose. */
export const cornersOf = ({ min, max }, pose) =>
  Array.from({ length: 8 }, (_, k) =>
    new Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z).applyMatrix4(
      pose,
    ),
  );
