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
