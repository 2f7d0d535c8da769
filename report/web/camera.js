// SPDX-License-Identifier: BSD-3-Clause
// From where the work is seen, and how near the camera may stand.
import { Box3, Vector3 } from 'three';
import { displacements, standing, vector } from './kinematics.js';
import { cornersOf, Occluder, Sight } from './sight.js';

// Where the camera may stand: turns about the vertical, in steps of 15 degrees from nearly ahead of
// -y, and angles above the ground, rad; above a map that lies on the floor only where x is to the
// right and y away, as in the map.
const kAllRound = {
    turns: Array.from({ length: 24 }, (_, k) => k),
    heights: [0.12, 0.3, 0.62, 1.0],
  },
  kAbove = { turns: [21, 22, 23, 0, 1, 2, 3, 4], heights: [0.62, 1.0] };
const kLong = 12, // worth of seeing the path in its whole extent
  kRoom = 1.06; // of the picture about what it must show

/**
 * The joints at which a page opens: past the end of every path, or at the row that comes nearest to
 * something, or at the first row; null where there are none.
 */
function openingJoints({ rows, cut }) {
  if (cut) return cut.q;
  const known = rows.filter(({ clearance_mm }) => clearance_mm !== undefined),
    nearest = known.reduce((a, b) => (b.clearance_mm < a.clearance_mm ? b : a), known[0]);
  return (nearest ?? rows[0])?.q ?? null;
}

/**
 * What a picture is to show: { points: corners of the bodies that move, at both ends of the path
 * and where the page opens, and the path itself; marks: [point, worth, body] that should be seen,
 * of which a point within a body names it; path; bodies: as of Sight; turns, heights: where the
 * camera may stand }, in the frame of what stands on the ground. parts: of View.
 */
export function subject(data, parts) {
  const { rows, chain, tool_path } = data,
    open = openingJoints(data),
    zero = chain.joints.map(() => 0);
  const poses = (q) => {
    const g = displacements(chain, q ?? zero),
      frame = standing(data, g);
    return parts.map(({ body, rest }) => frame.clone().multiply(g[body.group]).multiply(rest));
  };
  const frame = standing(data, displacements(chain, open ?? zero)),
    path = tool_path.map((point) => vector(point).applyMatrix4(frame));
  const points = [...path];
  for (const q of [open, rows[0]?.q, rows.at(-1)?.q])
    if (q)
      poses(q).forEach((pose, k) => {
        const { body, coarse } = parts[k];
        coarse.computeBoundingBox();
        if (body.kind !== 'scene' && !body.stands)
          points.push(...cornersOf(coarse.boundingBox, pose));
      });
  const bodies = poses(open).map((pose, k) => {
    parts[k].occluder ??= new Occluder(parts[k].coarse, parts[k].off);
    return { occluder: parts[k].occluder, pose };
  });
  const moving = bodies
    .map((_, k) => k)
    .filter((k) => {
      const { body } = parts[k];
      return body.kind !== 'scene' && !body.stands;
    });
  const row = rows.find(({ q, nearest }) => q === open && nearest),
    near = row ? [row.nearest] : data.cut?.line ? [data.cut.line.points] : [];
  const marks = [
    ...Array.from({ length: path.length ? 16 : 0 }, (_, k) => [
      path[Math.round((k / 15) * (path.length - 1))],
      2,
    ]),
    ...near.map((point) => [vector(point).applyMatrix4(frame), 6]),
    ...moving.map((k) => [
      bodies[k].occluder.box.getCenter(new Vector3()).applyMatrix4(bodies[k].pose),
      8 / moving.length,
      k,
    ]),
  ];
  return { points, marks, bodies, path, ...(data.floor ? kAbove : kAllRound) };
}

/**
 * How far the points of a path spread in a picture taken from a direction: the sum of the lengths
 * of the axes of their distribution. 0 for a straight path that is seen end-on.
 */
function spread(points, direction) {
  const right = new Vector3(-direction.y, direction.x, 0).normalize(),
    up = new Vector3().crossVectors(direction, right);
  let [x, y, xx, xy, yy] = [0, 0, 0, 0, 0];
  for (const point of points) {
    const [a, b] = [point.dot(right), point.dot(up)];
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
    yy += b * b;
  }
  const n = points.length || 1,
    [sx, sy, sxy] = [xx / n - (x / n) ** 2, yy / n - (y / n) ** 2, xy / n - (x * y) / n ** 2];
  return Math.sqrt(Math.max(0, sx + sy + 2 * Math.sqrt(Math.max(0, sx * sy - sxy * sxy))));
}

/**
 * The direction to the camera from which most of the path, of the arm and of the place that is
 * nearest to something is seen past all bodies, the arm's own among them, where the page opens.
 */
export function bestDirection({ points, marks, bodies, path, turns, heights }) {
  const box = new Box3().setFromPoints(points),
    target = box.getCenter(new Vector3()),
    radius = box.getSize(new Vector3()).length(),
    sight = new Sight(bodies),
    candidates = [];
  for (const up of heights)
    for (const k of turns) {
      const turn = -Math.PI / 2 - 0.4 + (k * Math.PI) / 12;
      const direction = new Vector3(
        Math.cos(turn) * Math.cos(up),
        Math.sin(turn) * Math.cos(up),
        Math.sin(up),
      );
      candidates.push({ up, k, direction, wide: spread(path, direction) });
    }
  const widest = Math.max(1e-6, ...candidates.map(({ wide }) => wide));
  let best = null;
  for (const { up, k, direction, wide } of candidates) {
    const from = target.clone().addScaledVector(direction, 1.6 * radius);
    let score =
      (kLong * wide) / widest +
      (up === 0.62 ? 1 : up === 0.12 ? -1 : 0) -
      0.035 * Math.min(k, 24 - k);
    for (const [point, worth, own] of marks) score += sight.hides(from, point, own) ? 0 : worth;
    if (best === null || score > best.score) best = { score, direction };
  }
  return best.direction;
}

/**
 * Places a camera so that it sees all points as large as its picture allows, looking against
 * `direction`. Returns the point at which it looks, at the depth of the middle of the points.
 */
export function fit(camera, points, direction) {
  const back = direction.clone().normalize(),
    right = new Vector3().crossVectors(camera.up, back);
  if (right.lengthSq() < 1e-12) right.set(0, 1, 0);
  right.normalize();
  const up = new Vector3().crossVectors(back, right),
    slope = Math.tan((camera.fov * Math.PI) / 360) / kRoom;
  // A point at x to the right and z before the middle is seen where x <= slope (d - z): of each
  // side the point that needs most decides.
  const most = (axis, tangent) => {
    let plus = -Infinity,
      minus = -Infinity;
    for (const point of points) {
      const x = point.dot(axis),
        z = tangent * point.dot(back);
      plus = Math.max(plus, x + z);
      minus = Math.max(minus, z - x);
    }
    return { middle: (plus - minus) / 2, away: (plus + minus) / 2 / tangent };
  };
  const across = most(right, slope * camera.aspect),
    high = most(up, slope),
    depth = points.reduce((sum, point) => sum + point.dot(back), 0) / points.length,
    away = Math.max(across.away, high.away, depth + 0.3);
  const target = right
    .clone()
    .multiplyScalar(across.middle)
    .addScaledVector(up, high.middle)
    .addScaledVector(back, depth);
  camera.position.copy(target).addScaledVector(back, away - depth);
  return target;
}
