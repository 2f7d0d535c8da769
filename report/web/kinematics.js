// SPDX-License-Identifier: BSD-3-Clause
// Forward kinematics as a product of exponentials; the chain is that of
// core/kinematics/chain/arm.hpp.
import { Matrix4, Vector3 } from 'three';

export const vector = (v) => new Vector3(v[0], v[1], v[2]);
export const matrix = (p) => new Matrix4().set(...p, 0, 0, 0, 1);

/** exp([S] angle) of the line through a joint's point along its axis. */
function turned(joint, angle) {
  const point = vector(joint.point);
  const turn = new Matrix4().makeRotationAxis(vector(joint.axis), angle);
  return turn.setPosition(point.clone().sub(point.clone().applyMatrix4(turn)));
}

/** How far a joint displaces what it carries, at q: rad, or m for one that slides. */
const moved = (joint, q) =>
  joint.slides
    ? new Matrix4().setPosition(vector(joint.axis).multiplyScalar(q))
    : turned(joint, q);

/**
 * The displacement of a body of each group from its pose at q = 0, base frame: G_0 ... G_7, then of
 * the joints that mimic the arm's. A chain of two arms has the joints of both, one arm after the
 * other: each then names the group that carries it (`parent`).
 */
export function displacements(chain, q) {
  const g = [new Matrix4()];
  chain.joints.forEach((joint, k) =>
    g.push(g[joint.parent ?? k].clone().multiply(moved(joint, q[k]))),
  );
  for (const follower of chain.followers ?? []) {
    const motion = follower.multiplier * q[follower.leader];
    g.push(g[follower.parent].clone().multiply(moved(follower, motion)));
  }
  return g;
}

/**
 * From the base frame to that of the link which stands on the ground: the same frame, but where
 * that link moves against the base, as with the part in the hand. g: displacements at the joints.
 */
export const standing = ({ ground }, g) =>
  ground ? g[ground.group].clone().multiply(matrix(ground.pose)).invert() : new Matrix4();

/** The tools of a chain: of one arm its own, of two arms that of each. */
export const toolsOf = (chain) => chain.tools ?? [{ group: chain.joints.length, home: chain.home }];
/** The poses of the tools of a chain; g: displacements at its joints. */
export const toolPoses = (chain, g) =>
  toolsOf(chain).map(({ group, home }) => g[group].clone().multiply(matrix(home)));
/** The pose of the tool of a chain of one arm. */
export const toolPose = (chain, q) => toolPoses(chain, displacements(chain, q))[0];

/**
 * Yoshikawa's sqrt(det(J J^T)), J the 6 x 7 geometric Jacobian at the base origin (the value does
 * not depend on the point).
 */
export function manipulability(chain, q) {
  const g = displacements(chain, q);
  const columns = chain.joints.map((joint, k) => {
    const axis = vector(joint.axis).transformDirection(g[k]);
    if (joint.slides) return [axis.x, axis.y, axis.z, 0, 0, 0];
    const point = vector(joint.point).applyMatrix4(g[k]);
    const linear = point.cross(axis);
    return [linear.x, linear.y, linear.z, axis.x, axis.y, axis.z];
  });
  const a = Array.from({ length: 6 }, (_, r) =>
    Array.from({ length: 6 }, (_, c) =>
      columns.reduce((sum, column) => sum + column[r] * column[c], 0),
    ),
  );
  let det = 1;
  for (let k = 0; k < 6; ++k) {
    // symmetric and not negative: elimination needs no pivots
    if (a[k][k] <= 1e-15) return 0;
    det *= a[k][k];
    for (let r = k + 1; r < 6; ++r) {
      const f = a[r][k] / a[k][k];
      for (let c = k; c < 6; ++c) a[r][c] -= f * a[k][c];
    }
  }
  return Math.sqrt(Math.max(0, det));
}
