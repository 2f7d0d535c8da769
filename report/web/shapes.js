// SPDX-License-Identifier: BSD-3-Clause
// The shapes of bodies.
import * as THREE from 'three';
import { bytes } from './bytes.js';

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
    shape.setAttribute(
      'position',
      new THREE.BufferAttribute(new Float32Array(bytes(meshes[body.mesh].vertices)), 3),
    );
    shape.setIndex(
      new THREE.BufferAttribute(new Uint32Array(bytes(meshes[body.mesh].triangles)), 1),
    );
    shape = shape.toNonIndexed();
    shape.computeVertexNormals();
    // All geometries alike, so that they can be merged.
    shape.setIndex([...Array(shape.attributes.position.count).keys()]);
  }
  shape.deleteAttribute('uv');
  // three.js turns about y, swivel about z.
  if (body.cylinder || body.capsule) shape.rotateX(Math.PI / 2);
  return shape;
}
