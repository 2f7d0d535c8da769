// SPDX-License-Identifier: BSD-3-Clause
// From where the work is seen, and how near the camera may stand.
import { Vector3 } from 'three';
import { displacements, standing, toolPose, toolPoses, toolsOf, vector } from './kinematics.js';
import { cornersOf, Occluder, Sight } from './sight.js';

// Where the camera may stand: turns about the vertical, degrees from nearly ahead of -y, and angles
// above the ground, rad; above a map that lies on the floor only where x is to the right and y
// away, as in the map.
const kAllRound = {
    turns: Array.from({ length: 36 }, (_, k) => 10 * k - 170),
    heights: [0.12, 0.3, 0.62, 1.0],
  },
  kAbove = { turns: [-45, -30, -15, 0, 15, 30, 45, 60], heights: [0.62, 1.0] };
const kMarks = 48, // places of the path that are looked for
  kPath = 112, // worth of seeing all of them, square to the path
  kEndOn = 0.4, // share of that worth where the path leads straight to the camera or away
  kTool = 16, // of seeing the tool's point
  kNearest = 56, // of seeing where the arm is nearest to something
  kArm = 24, // of seeing all its bodies
  kLong = 28, // of seeing the path in its whole extent
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
 * and where the page opens, and the path itself; marks: [{ points, of which one should be seen,
 * worth, own: number of the body that the points are within, if they are, along: direction of the
 * path there, if they are of it }]; path; bodies: as of
 * Sight; turns, heights: where the camera may stand }, in the frame of what stands on the ground.
 * parts: of View.
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
  // The tool on moves between strokes, and halfway between their corners.
  for (const corners of data.moves ?? [])
    corners.forEach((q, k) => {
      for (const share of k ? [0.5, 1] : [1]) {
        const at = q.map((v, j) => v + (1 - share) * ((corners[k - 1]?.[j] ?? v) - v)),
          way = standing(data, displacements(chain, at));
        points.push(new Vector3().setFromMatrixPosition(way.multiply(toolPose(chain, at))));
      }
    });
  const bodies = poses(open).map((pose, k) => {
    const { coarse, fine, off } = parts[k];
    parts[k].occluder ??= new Occluder(off ? coarse : fine, off, fine);
    return { occluder: parts[k].occluder, pose };
  });
  const moving = bodies
    .map((_, k) => k)
    .filter((k) => {
      const { body } = parts[k];
      return body.kind !== 'scene' && !body.stands;
    });
  const row = rows.find(({ q, nearest }) => nearest && q.every((v, j) => v === open[j])),
    line = row?.nearest ?? data.cut?.line?.points;
  const marks = [
    ...Array.from({ length: path.length ? kMarks : 0 }, (_, k) => {
      const at = Math.round((k / (kMarks - 1)) * (path.length - 1));
      return { points: [path[at]], worth: kPath / kMarks, along: wayAt(path, at) };
    }),
    ...(open ? toolPoints(chain, open, frame) : []).map((point) => ({
      points: [point],
      worth: kTool / toolsOf(chain).length,
    })),
    ...moving.map((k) => ({
      points: [bodies[k].occluder.box.getCenter(new Vector3()).applyMatrix4(bodies[k].pose)],
      worth: kArm / moving.length,
      own: k,
    })),
  ];
  if (line) {
    const ends = [line.slice(0, 3), line.slice(3)].map((end) => vector(end).applyMatrix4(frame));
    marks.push({ points: ends, worth: kNearest });
    for (const end of ends) marks.push({ points: [end], worth: kNearest / 4 });
  }
  return { points, marks, bodies, path, ...(data.floor ? kAbove : kAllRound) };
}

/** The direction of a path at one of its points; null where it goes nowhere. */
function wayAt(path, k) {
  const way = path[Math.min(path.length - 1, k + 1)].clone().sub(path[Math.max(0, k - 1)]);
  return way.lengthSq() > 0 ? way.normalize() : null;
}
/** Where the tools of a chain are at joints q; frame: of what stands on the ground. */
function toolPoints(chain, q, frame) {
  return toolPoses(chain, displacements(chain, q)).map((pose) =>
    new Vector3().setFromMatrixPosition(frame.clone().multiply(pose)),
  );
}
/** What a mark is worth that is seen along a direction. */
function worthFrom({ worth, along }, direction) {
  if (!along) return worth;
  const square = Math.sqrt(Math.max(0, 1 - along.dot(direction) ** 2));
  return worth * (kEndOn + (1 - kEndOn) * square);
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
 * The direction to the camera from which most of the path, of the tool, of the arm and of the place
 * that is nearest to something is seen past all bodies, the arm's own among them, where the page
 * opens. camera: with the field of view and the aspect of the picture.
 */
export function bestDirection({ points, marks, bodies, path, turns, heights }, camera) {
  const eye = camera.clone(),
    sight = new Sight(bodies),
    candidates = [];
  for (const up of heights)
    for (const from of turns) {
      const turn = -Math.PI / 2 - 0.4 + (from * Math.PI) / 180;
      const direction = new Vector3(
        Math.cos(turn) * Math.cos(up),
        Math.sin(turn) * Math.cos(up),
        Math.sin(up),
      );
      candidates.push({ up, from, direction, wide: spread(path, direction) });
    }
  const widest = Math.max(1e-6, ...candidates.map(({ wide }) => wide));
  let best = null;
  for (const { up, from, direction, wide } of candidates) {
    fit(eye, points, direction);
    // As if all were seen, less what is hidden: no candidate is followed below the best one.
    let score =
      marks.reduce((sum, mark) => sum + worthFrom(mark, direction), 0) +
      (kLong * wide) / widest +
      (up === 0.62 ? 1 : up === 0.12 ? -1 : 0) -
      0.0023 * Math.abs(from);
    for (const mark of marks) {
      if (best && score <= best.score) break;
      if (mark.points.every((place) => sight.hides(eye.position, place, mark.own)))
        score -= worthFrom(mark, direction);
    }
    if (!best || score > best.score) best = { score, direction };
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
