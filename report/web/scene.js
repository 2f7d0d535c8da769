// SPDX-License-Identifier: BSD-3-Clause
// The arm among the scene in three dimensions. Draws only when something changed.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js';
import { bytes } from './bytes.js';
import { displacements, matrix, vector } from './kinematics.js';
import { Quality } from './quality.js';
import { surface } from './surface.js';

const kFine = 24, kCoarse = 10;

/** From blue (0) over grey to yellow (1): told apart by all kinds of colour vision. After cividis. */
export function ramp(t) {
  const stops = [[0, 45, 110], [90, 96, 110], [143, 139, 120], [203, 186, 105], [253, 231, 55]];
  const x = Math.min(0.9999, Math.max(0, t)) * 4, k = Math.floor(x), f = x - k;
  return stops[k].map((v, c) => (v + f * (stops[k + 1][c] - v)) / 255);
}

/** around: corners of a circle. */
function geometry(body, meshes, around) {
  let shape;
  if (body.sphere) shape = new THREE.SphereGeometry(body.sphere, around, around >> 1);
  else if (body.box) shape = new THREE.BoxGeometry(...body.box);
  else if (body.cylinder) shape = new THREE.CylinderGeometry(body.cylinder[0], body.cylinder[0], body.cylinder[1], around);
  else if (body.capsule) shape = new THREE.CapsuleGeometry(body.capsule[0], body.capsule[1], around >> 2, around);
  else {
    shape = new THREE.BufferGeometry();
    shape.setAttribute('position', new THREE.BufferAttribute(new Float32Array(bytes(meshes[body.mesh].vertices)), 3));
    shape.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes(meshes[body.mesh].triangles)), 1));
    shape = shape.toNonIndexed();
    shape.computeVertexNormals();
    shape.setIndex([...Array(shape.attributes.position.count).keys()]);  // all geometries alike, so that they can be merged
  }
  shape.deleteAttribute('uv');
  if (body.cylinder || body.capsule) shape.rotateX(Math.PI / 2);  // three.js turns about y, swivel about z
  return shape;
}

export class View {
  /** gap: an element that is kept beside the line between the nearest bodies. */
  constructor(canvas, gap, data) {
    Object.assign(this, { data, canvas, gap });
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false });  // edges are smoothed by drawing more pixels at rest
    this.quality = new Quality();
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.02, 50);
    this.camera.up.set(0, 0, 1);
    this.addGrid();
    this.parts = data.bodies.map((body) => {
      const fine = geometry(body, data.meshes, kFine), coarse = body.mesh === undefined ? geometry(body, data.meshes, kCoarse) : fine;
      return { body, fine, coarse, rest: matrix(body.pose) };
    });
    this.materials = { robot: surface(0xf0a830), tool: surface(0x59636f), scene: surface(0x93a3b3, { twoSided: true }), near: surface(0xd55e00), 'near scene': surface(0xd9a58c, { twoSided: true }) };
    this.arm = this.parts.map((part) => {
      const mesh = new THREE.Mesh(part.fine, this.materials[part.body.kind]);
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(part.rest);
      mesh.userData = part;
      this.scene.add(mesh);
      return mesh;
    });
    this.addGhosts();
    this.addPath();
    this.addNearest();
    this.orbit = new OrbitControls(this.camera, canvas);
    this.frame();
    this.orbit.addEventListener('change', () => (this.dirty = this.moving = true));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }
  addGrid() {
    const grid = new THREE.GridHelper(4, 20);
    grid.geometry.deleteAttribute('color');
    grid.material = surface(0x888888, { opacity: 0.25, lit: false });
    grid.rotation.x = Math.PI / 2;
    this.scene.add(grid);
  }
  /** The poses at start and end, one body each, that do not hide what moves. */
  addGhosts() {
    this.ghosts = new THREE.Group();
    this.scene.add(this.ghosts);
    const { rows, chain } = this.data;
    if (rows.length < 2) return;
    for (const [row, colour] of [[rows[0], 0x0072b2], [rows.at(-1), 0x009e73]]) {
      const g = displacements(chain, row.q);
      const bodies = this.parts.filter(({ body }) => body.group > 0)
        .map(({ body, coarse, rest }) => coarse.clone().applyMatrix4(g[body.group].clone().multiply(rest)));
      this.ghosts.add(new THREE.Mesh(mergeGeometries(bodies), surface(colour, { opacity: 0.2, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 })));
    }
  }
  addPath() {
    const points = this.data.tool_path.map(vector);
    this.rings = Math.min(2 * points.length, 200);
    const tube = points.length > 1 ? new THREE.TubeGeometry(new THREE.CatmullRomCurve3(points, false, 'centripetal'), this.rings, 0.004, 5) : new THREE.BufferGeometry();
    this.line = new THREE.Mesh(tube, surface(null));
    this.scene.add(this.line);
    this.around = 6;  // vertices of a ring: the first again at the end
  }
  /** The shortest line between two bodies, drawn over everything. */
  addNearest() {
    const material = surface(0xc2185b, { lit: false, depthTest: false });
    const rod = new THREE.CylinderGeometry(0.0025, 0.0025, 1, 6).rotateX(Math.PI / 2), dot = new THREE.SphereGeometry(0.007, 10, 8);
    this.nearest = new THREE.Group();
    this.nearest.add(...[rod, dot, dot].map((shape) => Object.assign(new THREE.Mesh(shape, material), { renderOrder: 1 })));
    this.nearest.visible = false;
    this.scene.add(this.nearest);
  }
  /** Robot and path into the picture. */
  frame() {
    const box = new THREE.Box3().setFromPoints(this.data.tool_path.map(vector));
    const target = box.getCenter(new THREE.Vector3()).multiplyScalar(0.6).add(new THREE.Vector3(0, 0, 0.35));
    this.camera.position.copy(target).add(new THREE.Vector3(-0.8, -1.9, 1.1).normalize().multiplyScalar(2.3));
    this.orbit.target.copy(target);
    this.orbit.update();
  }
  /** pair: names of the two bodies that are nearest, or null; line: { points (six numbers), text } between them, or null. */
  pose(q, pair, line = null) {
    const g = displacements(this.data.chain, q);
    for (const mesh of this.arm) {
      const { body, rest } = mesh.userData;
      mesh.matrix.multiplyMatrices(g[body.group], rest);
      const kind = pair?.includes(body.name) ? (body.kind === 'scene' ? 'near scene' : 'near') : body.kind;
      mesh.material = this.materials[kind];
    }
    this.nearest.visible = line !== null;
    this.gap.hidden = line === null;
    if (line) {
      const [rod, ...dots] = this.nearest.children, from = vector(line.points.slice(0, 3)), to = vector(line.points.slice(3));
      rod.position.lerpVectors(from, to, 0.5);
      rod.lookAt(to);
      rod.scale.z = Math.max(1e-6, from.distanceTo(to));
      dots[0].position.copy(from);
      dots[1].position.copy(to);
      this.gap.textContent = line.text;
    }
    this.dirty = true;
  }
  /** values: one in 0..1 for each layer of the path, or NaN where nothing is known. */
  colourPath(values) {
    const count = this.line.geometry.attributes.position?.count ?? 0, colours = new Float32Array(3 * count);
    for (let k = 0; k < count; ++k) {
      const value = values[Math.round((Math.floor(k / this.around) / this.rings) * (values.length - 1))];
      colours.set(Number.isNaN(value) || value === undefined ? [0.55, 0.55, 0.55] : ramp(value), 3 * k);
    }
    this.line.geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
    this.dirty = true;
  }
  background(colour) {
    this.scene.background = new THREE.Color(colour);
    this.dirty = true;
  }
  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    this.size = { width, height };
    this.renderer.setPixelRatio(this.quality.ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }
  /** Draws if something changed; true when it did. now: ms; playing: more frames will follow. */
  draw(now, playing) {
    if (this.quality.changed(now, playing || this.moving)) {
      for (const mesh of this.arm) mesh.geometry = this.quality.coarse ? mesh.userData.coarse : mesh.userData.fine;
      this.resize();
    }
    if (!this.dirty) return false;
    this.dirty = this.moving = false;
    this.renderer.render(this.scene, this.camera);
    if (this.nearest.visible) this.placeGap();
    return true;
  }
  placeGap() {
    const at = this.nearest.children[0].position.clone().project(this.camera), { width, height } = this.size;
    const x = ((at.x + 1) / 2) * width, y = ((1 - at.y) / 2) * height;
    this.gap.style.transform = `translate(${Math.min(Math.max(4, x + 12), width - 90).toFixed(0)}px, ${Math.min(Math.max(4, y - 26), height - 24).toFixed(0)}px)`;
  }
}
