// SPDX-License-Identifier: BSD-3-Clause
// The shapes of bodies.
import * as THREE from 'three';
import { triangles } from './bytes.js';

/** around: corners of a circle. */
export function geometry(body, meshes, around) {
  let shape;
  if (body.sphere) shape = new THREE.SphereGeometry(body.sphere, around, around >> 1);
  else if (body.box) shape = new THREE.BoxGeometry(...body.box);
  else if (body.cylinder)
    shape = new THREE.CylinderGeometry(
      body.cylinder[0],
      body.cylinder[0],
      body.cylinder[1],
      around,
    );
  else if (body.capsule)
    shape = new THREE.CapsuleGeometry(body.capsule[0], body.capsule[1], around >> 2, around);
  else {
    shape = new THREE.BufferGeometry();
    const { points, corners } = triangles(meshes[body.mesh]);
    shape.setAttribute('position', new THREE.BufferAttribute(points, 3));
    shape.setIndex(new THREE.BufferAttribute(corners, 1));
    shape = shape.toNonIndexed();
    shape.computeVertexNormals();
  }
  shape.deleteAttribute('uv');
  // three.js turns about y, swivel about z.
  if (body.cylinder || body.capsule) shape.rotateX(Math.PI / 2);
  return shape;
}

const kHeavy = 12000, // triangles
  kCells = 40; // along the longest edge of a mesh's box
/**
 * A mesh with fewer triangles for pictures in motion: corners in one cell of a grid become one, at
 * their middle. { shape, off: how far it may be from the mesh, m }; light meshes stay as they are.
 */
export function thinned(shape) {
  const { position } = shape.attributes;
  if (position.count <= 3 * kHeavy) return { shape, off: 0 };
  shape.computeBoundingBox();
  const { min } = shape.boundingBox,
    size = shape.boundingBox.getSize(new THREE.Vector3()),
    cell = Math.max(size.x, size.y, size.z) / kCells,
    cells = new Map(), // number of a cell: number of its corner
    sums = [], // x, y, z and how many, of each corner
    kept = new Set(),
    corners = [];
  const corner = (k) => {
    const at = [position.getX(k), position.getY(k), position.getZ(k)],
      [i, j, l] = at.map((v, axis) => Math.floor((v - min.getComponent(axis)) / cell)),
      key = (i * 64 + j) * 64 + l,
      known = cells.get(key) ?? cells.size;
    if (known === cells.size) {
      cells.set(key, known);
      sums.push(0, 0, 0, 0);
    }
    at.forEach((v, axis) => (sums[4 * known + axis] += v));
    ++sums[4 * known + 3];
    return known;
  };
  for (let k = 0; k < position.count; k += 3) {
    const [a, b, c] = [corner(k), corner(k + 1), corner(k + 2)];
    if (a === b || b === c || c === a) continue;
    const least = Math.min(a, b, c), // turned so that it begins with the least corner
      [p, q, r] = least === a ? [a, b, c] : least === b ? [b, c, a] : [c, a, b],
      key = (p * 65536 + q) * 65536 + r;
    if (kept.has(key)) continue;
    kept.add(key);
    corners.push(p, q, r);
  }
  const points = new Float32Array(3 * corners.length);
  corners.forEach((number, k) =>
    points.set(
      [0, 1, 2].map((axis) => sums[4 * number + axis] / sums[4 * number + 3]),
      3 * k,
    ),
  );
  const result = new THREE.BufferGeometry();
  result.setAttribute('position', new THREE.BufferAttribute(points, 3));
  result.computeVertexNormals();
  return { shape: result, off: 1.8 * cell };
}
