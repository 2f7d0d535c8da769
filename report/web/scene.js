// SPDX-License-Identifier: BSD-3-Clause
// The arm among the scene in three dimensions. Draws only when something changed.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { displacements, matrix, vector } from './kinematics.js';

export const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

/** From blue (0) over grey to yellow (1): told apart by all kinds of colour vision. After cividis. */
export function ramp(t) {
  const stops = [[0, 45, 110], [90, 96, 110], [143, 139, 120], [203, 186, 105], [253, 231, 55]];
  const x = Math.min(0.9999, Math.max(0, t)) * 4, k = Math.floor(x), f = x - k;
  return stops[k].map((v, c) => (v + f * (stops[k + 1][c] - v)) / 255);
}

/** True where WebGL is done by the processor: smooth edges cost more than they are worth there. */
function software(document) {
  const gl = document.createElement('canvas').getContext('webgl'), info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

function geometry(body, meshes) {
  let shape;
  if (body.sphere) shape = new THREE.SphereGeometry(body.sphere, 24, 16);
  else if (body.box) shape = new THREE.BoxGeometry(...body.box);
  else if (body.cylinder) shape = new THREE.CylinderGeometry(body.cylinder[0], body.cylinder[0], body.cylinder[1], 32);
  else if (body.capsule) shape = new THREE.CapsuleGeometry(body.capsule[0], body.capsule[1], 8, 24);
  else {
    shape = new THREE.BufferGeometry();
    shape.setAttribute('position', new THREE.BufferAttribute(new Float32Array(bytes(meshes[body.mesh].vertices)), 3));
    shape.setIndex(new THREE.BufferAttribute(new Uint32Array(bytes(meshes[body.mesh].triangles)), 1));
    shape = shape.toNonIndexed();
    shape.computeVertexNormals();
  }
  if (body.cylinder || body.capsule) shape.rotateX(Math.PI / 2);  // three.js turns about y, swivel about z
  return shape;
}

export class View {
  constructor(canvas, data) {
    this.data = data;
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: devicePixelRatio < 1.5 && !software(canvas.ownerDocument) });
    this.ratio = Math.min(2, devicePixelRatio);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.02, 50);
    this.camera.up.set(0, 0, 1);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8d8d8d, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(-2, -3, 5);
    this.scene.add(sun);
    const grid = new THREE.GridHelper(4, 20, 0x888888, 0x888888);
    grid.rotation.x = Math.PI / 2;
    grid.material.transparent = true;
    grid.material.opacity = 0.25;
    this.scene.add(grid);
    this.parts = data.bodies.map((body) => ({ body, geometry: geometry(body, data.meshes), rest: matrix(body.pose) }));
    const solid = (color) => new THREE.MeshLambertMaterial({ color });
    this.materials = { robot: solid(0xf0a830), tool: solid(0x454d57), scene: new THREE.MeshLambertMaterial({ color: 0x93a3b3, side: THREE.DoubleSide }), near: solid(0xd55e00) };
    this.arm = this.posed((part) => this.materials[part.body.kind], () => true);
    this.ghosts = new THREE.Group();
    this.scene.add(this.ghosts);
    const ghost = (color) => new THREE.MeshLambertMaterial({ color, transparent: true, opacity: 0.2, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    if (data.rows.length > 1) {
      for (const [row, color] of [[data.rows[0], 0x0072b2], [data.rows.at(-1), 0x009e73]]) {
        const material = ghost(color), meshes = this.posed(() => material, (part) => part.body.group > 0, this.ghosts);
        this.place(meshes, row.q);
      }
    }
    const points = data.tool_path.map(vector);
    this.line = new THREE.Mesh(new THREE.TubeGeometry(new THREE.CatmullRomCurve3(points, false, 'centripetal'), points.length * 2, 0.004, 6), new THREE.MeshBasicMaterial({ vertexColors: true }));
    this.scene.add(this.line);
    const box = new THREE.Box3().setFromPoints(points);
    const target = box.getCenter(new THREE.Vector3()).multiplyScalar(0.6).add(new THREE.Vector3(0, 0, 0.35));
    this.camera.position.copy(target).add(new THREE.Vector3(-0.8, -1.9, 1.1).normalize().multiplyScalar(2.3));
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.target.copy(target);
    this.orbit.update();
    this.orbit.addEventListener('change', () => (this.dirty = true));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }
  posed(material, wanted, group = this.scene) {
    return this.parts.filter(wanted).map((part) => {
      const mesh = new THREE.Mesh(part.geometry, material(part));
      mesh.matrixAutoUpdate = false;
      mesh.matrix.copy(part.rest);
      mesh.userData = part;
      group.add(mesh);
      return mesh;
    });
  }
  place(meshes, q) {
    const g = displacements(this.data.chain, q);
    for (const mesh of meshes) mesh.matrix.multiplyMatrices(g[mesh.userData.body.group], mesh.userData.rest);
    this.dirty = true;
  }
  /** pair: names of the two bodies that are nearest, or null. */
  pose(q, pair) {
    this.place(this.arm, q);
    for (const mesh of this.arm) {
      const { name, kind } = mesh.userData.body;
      mesh.material = pair && pair.includes(name) ? this.materials.near : this.materials[kind];
    }
  }
  /** values: one in 0..1 for each layer of the path, or NaN where nothing is known. */
  colourPath(values) {
    const count = this.line.geometry.attributes.position.count, around = 7, colours = new Float32Array(3 * count);
    const rings = count / around;
    for (let k = 0; k < count; ++k) {
      const value = values[Math.round((Math.floor(k / around) / (rings - 1)) * (values.length - 1))];
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
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }
  /** Coarser pixels while playing, down to half, where the machine cannot draw 30 frames a second; full ones at rest. */
  keepUp(playing, ms) {
    const full = Math.min(2, devicePixelRatio);
    const wanted = !playing ? full : ms > 36 ? Math.max(0.5, this.ratio * 0.8) : this.ratio;
    if (wanted === this.ratio) return;
    this.ratio = wanted;
    this.resize();
  }
  draw() {
    if (!this.dirty) return false;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    return true;
  }
}
