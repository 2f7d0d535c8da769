// SPDX-License-Identifier: BSD-3-Clause
// The arm among the scene in three dimensions. Draws only when something changed.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { mergeGeometries } from 'three/addons/utils/BufferGeometryUtils.js';
import { BodyList, entryOf, kindOf } from './bodylist.js';
import { bestDirection, fit, subject } from './camera.js';
import {
  displacements,
  matrix,
  standing,
  toolPose,
  toolPoses,
  toolsOf,
  vector,
} from './kinematics.js';
import { $, isDark } from './page.js';
import { kBodies, kLines, ramp } from './palette.js';
import { Quality } from './quality.js';
import { geometry, thinned } from './shapes.js';
import { cornersOf } from './sight.js';
import { surface } from './surface.js';

const kFine = 24, // corners of a circle
  kCoarse = 10;
const kTrail = 7; // poses
const kArrow = { ofPath: 0.07, ofArm: 1 / 25, least: 0.006 }; // length of an arrow; least: m
const kDash = 0.012; // m, of a move between strokes, with the gap behind it
const kAside = [0, 18, -18, 36, -36]; // pixels down, from where a name belongs
const kFree = { places: 16, path: 3, tool: 12 }; // of a path; pixels about a place, and a tool
const toolPoint = (chain, q) => new THREE.Vector3().setFromMatrixPosition(toolPose(chain, q));
function rodBetween(from, to) {
  const rod = new THREE.CylinderGeometry(0.003, 0.003, from.distanceTo(to), 5),
    way = to.clone().sub(from).normalize();
  rod.deleteAttribute('uv');
  return rod
    .applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), way))
    .translate(...from.clone().lerp(to, 0.5));
}

/** Whether a body of the robot stands on the ground. */
const stands = ({ kind, group }, ground) =>
  ground ? kind === 'robot' && group === ground.group : kind !== 'scene' && group === 0;

class View {
  /** gap: an element that is kept beside the line between the nearest bodies. */
  constructor(canvas, gap, data) {
    Object.assign(this, { canvas, gap });
    // Edges are smoothed by drawing more pixels at rest.
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false });
    this.quality = new Quality();
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.02, 50);
    this.camera.up.set(0, 0, 1);
    this.addGrid();
    // All but the grid and ghosts is in the base frame.
    this.world = Object.assign(new THREE.Group(), { matrixAutoUpdate: false });
    this.scene.add(this.world);
    this.parts = data.bodies.map((one) => this.part(one, data));
    const materials = (settings) =>
      Object.fromEntries(
        Object.entries(kBodies).map(([kind, colour]) => [
          kind,
          surface(colour, { twoSided: kind.includes('scene'), ...settings }),
        ]),
      );
    this.reach = this.extentOfArm();
    this.materials = materials({});
    this.faded = materials({ opacity: 0.1, rim: 0.25 });
    this.looks = new Map(); // of bodies that are not just shown: 'faded' or 'hidden', by legend
    this.visual = new Set(); // links of which visual shapes are shown
    this.arm = this.parts.map((part) => this.meshOf(part));
    this.addNearest();
    this.tools = toolsOf(data.chain).map(() => this.addTool());
    this.paint();
    this.show(data);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.resize();
    this.look('best');
    this.orbit.addEventListener('change', () => (this.dirty = this.moving = true));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }
  /** What is drawn of a body of the page's data. */
  part(one, data) {
    const body = {
        ...one,
        stands: stands(one, data.ground),
        isSecond: one.arm !== undefined && one.arm === data.arms?.[1]?.name,
      },
      fine = geometry(body, data.meshes, kFine),
      { shape: coarse, off } =
        body.mesh === undefined
          ? { shape: geometry(body, data.meshes, kCoarse), off: 0 }
          : thinned(fine);
    return { body, fine, coarse, off, rest: matrix(body.pose) };
  }
  /** How large the bodies that move are together, as they stand at rest, m. */
  extentOfArm() {
    const box = new THREE.Box3();
    for (const { body, fine, rest } of this.parts) {
      if (body.kind === 'scene' || body.stands) continue;
      fine.computeBoundingBox();
      box.union(fine.boundingBox.clone().applyMatrix4(rest));
    }
    return box.isEmpty() ? 1 : box.getSize(new THREE.Vector3()).length();
  }
  meshOf(part) {
    const mesh = new THREE.Mesh(part.fine);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(part.rest);
    mesh.userData = part;
    this.dress(mesh, kindOf(part.body));
    this.world.add(mesh);
    return mesh;
  }
  /** Shows the visual shapes of links that have some, or the collision shapes of all. */
  showVisual(on) {
    const { visual, chain } = this.data,
      g =
        this.displaced ??
        displacements(
          chain,
          chain.joints.map(() => 0),
        );
    if (on && !this.arm.some(({ userData }) => userData.body.visual))
      for (const one of visual) {
        const mesh = this.meshOf(this.part({ ...one, visual: true }, this.data));
        this.placeVisual(mesh.userData);
        mesh.matrix.multiplyMatrices(g[one.group], mesh.userData.rest);
        this.arm.push(mesh);
      }
    this.visual = new Set(on ? visual.map(({ name }) => name) : []);
    // A link is in the colours of its collision shape.
    const kinds = new Map(
      this.arm
        .filter(({ userData: { body } }) => !body.visual && body.kind === 'robot')
        .map(({ userData: { body, kind } }) => [body.name, kind]),
    );
    for (const mesh of this.arm) {
      const { body, kind } = mesh.userData;
      this.dress(mesh, (body.visual && kinds.get(body.name)) || kind || kindOf(body));
    }
    this.dirty = true;
  }
  /** Puts a visual shape onto its link, which may stand elsewhere than the shape's pose says. */
  placeVisual({ body, rest }) {
    const { links, own_links: own } = this.data;
    rest.copy(matrix(body.pose));
    if (links && own)
      rest.premultiply(matrix(links[body.name]).multiply(matrix(own[body.name]).invert()));
  }
  /**
   * Another plan of the same arm among the same bodies. poses, robot_poses: of the scene's objects
   * and of the other bodies in their order, where they stand elsewhere; links, own_links: of the
   * links as they stand here and as the shapes are given.
   */
  show(data) {
    this.data = data;
    const move = (poses, isOfScene) =>
      this.parts
        .filter(({ body }) => (body.kind === 'scene') === isOfScene)
        .forEach(({ rest }, k) => rest.copy(matrix(poses[k])));
    if (data.poses) move(data.poses, true);
    if (data.robot_poses) move(data.robot_poses, false);
    for (const { userData } of this.arm) if (userData.body.visual) this.placeVisual(userData);
    // Ghosts share the shapes of the arm.
    this.shown?.traverse(({ geometry, userData }) => userData.g ?? geometry?.dispose());
    for (const one of [this.shown, this.ghosts, this.trail]) one?.removeFromParent();
    for (const { label } of this.names ?? []) label.remove();
    this.shown = new THREE.Group();
    this.world.add(this.shown);
    // What each tool carries along.
    this.carried = toolsOf(data.chain).map(() => {
      const group = Object.assign(new THREE.Group(), { matrixAutoUpdate: false });
      this.shown.add(group);
      return group;
    });
    this.addGhosts();
    this.addPath();
    this.addNames();
    this.dirty = true;
  }
  /**
   * Coloured squares { x, y, half: [hx, hy], colour } in a frame (its pose), below all that stands
   * on them; a ring at one point of theirs.
   */
  lay(squares, frame, ring) {
    this.floor?.traverse(({ geometry }) => geometry?.dispose());
    this.floor?.removeFromParent();
    const corners = new Float32Array(12 * squares.length),
      colours = new Float32Array(12 * squares.length),
      index = new Uint32Array(6 * squares.length),
      known = new Map();
    const rgb = (colour) =>
      known.get(colour) ??
      known.set(colour, new THREE.Color(colour).convertLinearToSRGB().toArray()).get(colour);
    squares.forEach(({ x, y, half: [hx, hy], colour }, k) => {
      corners.set(
        [x - hx, y - hy, 0, x + hx, y - hy, 0, x + hx, y + hy, 0, x - hx, y + hy, 0],
        12 * k,
      );
      for (let c = 0; c < 4; ++c) colours.set(rgb(colour), 12 * k + 3 * c);
      index.set(
        [0, 1, 2, 0, 2, 3].map((c) => 4 * k + c),
        6 * k,
      );
    });
    const shape = new THREE.BufferGeometry()
      .setAttribute('position', new THREE.BufferAttribute(corners, 3))
      .setAttribute('color', new THREE.BufferAttribute(colours, 3))
      .setIndex(new THREE.BufferAttribute(index, 1));
    const mark = new THREE.Mesh(
      new THREE.RingGeometry(0.012, 0.018, 32),
      surface(0x000000, { lit: false, side: THREE.DoubleSide }),
    );
    mark.position.set(...ring, 0.001);
    this.floor = new THREE.Group();
    this.floor.add(new THREE.Mesh(shape, surface(null, { lit: false, twoSided: true })), mark);
    this.floor.matrixAutoUpdate = false;
    this.floor.matrix.copy(matrix(frame));
    this.floor.matrix.elements[14] = Math.min(0, this.lowest()) + 0.002;
    this.world.add(this.floor);
    const box = new THREE.Box3().setFromBufferAttribute(shape.attributes.position);
    this.floorCorners = squares.length ? cornersOf(box, this.floor.matrix) : [];
    this.dirty = true;
  }
  /** z of the lowest point of the scene. */
  lowest() {
    return this.parts
      .filter(({ body }) => body.kind === 'scene')
      .reduce((least, { fine, rest }) => {
        fine.computeBoundingBox();
        return Math.min(least, fine.boundingBox.clone().applyMatrix4(rest).min.z);
      }, Infinity);
  }
  addGrid() {
    const grid = new THREE.GridHelper(4, 20);
    grid.geometry.deleteAttribute('color');
    grid.material = surface(0x888888, { opacity: 0.25, lit: false });
    grid.rotation.x = Math.PI / 2;
    this.scene.add(grid);
  }
  /** The arm at start and end, as outlines that do not hide what moves. */
  addGhosts() {
    this.ghosts = Object.assign(new THREE.Group(), { visible: this.ghosts?.visible ?? true });
    this.scene.add(this.ghosts);
    const { rows } = this.data;
    if (rows.length < 2) return;
    for (const [row, colour] of [
      [rows[0], kBodies.start],
      [rows.at(-1), kBodies.end],
    ])
      this.ghosts.add(...this.ghost(row.q, surface(colour, { opacity: 0.06, rim: 0.5 })));
    this.paintGhosts();
    if (this.trail) this.showTrail(true);
  }
  /** Outlines are seen less on a dark ground. */
  paintGhosts() {
    for (const { material } of this.ghosts?.children ?? [])
      material.uniforms.rim.value = isDark() ? 1 : 0.5;
  }
  /** The bodies that move, at joints q. */
  ghost(q, material) {
    const g = displacements(this.data.chain, q),
      frame = standing(this.data, g);
    return this.parts
      .filter(({ body }) => body.kind !== 'scene' && !body.stands)
      .map(({ body, coarse, rest }) => {
        const mesh = new THREE.Mesh(coarse, material),
          moved = frame.clone().multiply(g[body.group]);
        mesh.matrixAutoUpdate = false;
        mesh.matrix.multiplyMatrices(moved, rest);
        mesh.userData = { group: body.group, g: moved };
        return mesh;
      });
  }
  /** Ghosts that stand where the arm stands would only tint it. */
  hideGhostsOfArm(g) {
    const same = (a, b) => a.every((v, k) => Math.abs(v - b[k]) < (k < 12 ? 0.03 : 0.008));
    for (const mesh of [...this.ghosts.children, ...(this.trail?.children ?? [])])
      mesh.visible = !same(
        mesh.userData.g.elements,
        this.world.matrix.clone().multiply(g[mesh.userData.group]).elements,
      );
  }
  /** The arm at kTrail places between start and end. */
  showTrail(on) {
    this.trail?.removeFromParent();
    this.trail = null;
    this.dirty = true;
    const { rows } = this.data;
    if (!on || rows.length < 3) return;
    this.trail = new THREE.Group();
    const material = surface(kBodies.robot, { opacity: 0.02, rim: 0.3 });
    for (let k = 1; k <= kTrail; ++k)
      this.trail.add(
        ...this.ghost(rows[Math.round((k * (rows.length - 1)) / (kTrail + 1))].q, material),
      );
    this.scene.add(this.trail);
  }
  /**
   * Where the tools go: on the path, or on several, some of which a tool carries along (`on`: the
   * number of that tool, or null, of each path); with moves between them, or other ways, dashed.
   */
  addPath() {
    const { tool_path, paths, moves, on, ways } = this.data;
    this.lines = (paths ?? [tool_path]).map((path, k) =>
      this.addLine(path.map(vector), this.carried[on?.[k]] ?? this.shown),
    );
    if (moves?.length) this.addMoves(moves);
    if (ways?.length) this.addWays(ways);
  }
  /** A path in a group that colourPath() colours; arrows tell its direction. */
  addLine(points, group) {
    const rings = Math.min(2 * points.length, 200),
      isPoint = points.every((point) => point.distanceTo(points[0]) < 1e-6),
      extent = new THREE.Box3().setFromPoints(points).getSize(new THREE.Vector3()).length(),
      arrow = Math.max(kArrow.least, Math.min(kArrow.ofPath * extent, kArrow.ofArm * this.reach));
    const tube =
      points.length > 1 && !isPoint
        ? new THREE.TubeGeometry(
            new THREE.CatmullRomCurve3(points, false, 'centripetal'),
            rings,
            Math.max(0.0015, arrow / 8),
            5,
          )
        : new THREE.BufferGeometry();
    // What bodies hide of the path shows through them, faintly.
    const through = Object.assign(
      new THREE.Mesh(tube, surface(null, { opacity: 0.3, lit: false, depthTest: false })),
      { renderOrder: 1 },
    );
    group.add(new THREE.Mesh(tube, surface(null)), through);
    const length = points.reduce(
      (sum, point, k) => sum + (k ? point.distanceTo(points[k - 1]) : 0),
      0,
    );
    const cone = new THREE.ConeGeometry(arrow / 2.7, arrow, 10).rotateX(Math.PI / 2),
      dark = surface(0x1b222b, { opacity: 0.75, depthTest: false });
    for (let k = 1, passed = 0, next = length / 8; k < points.length && length > 4 * arrow; ++k) {
      const way = points[k].clone().sub(points[k - 1]);
      passed += way.length();
      if (passed < next) continue;
      next += length / 4;
      const mesh = Object.assign(new THREE.Mesh(cone, dark), { renderOrder: 2 });
      mesh.position.copy(points[k]);
      mesh.lookAt(points[k].clone().add(way));
      group.add(mesh);
    }
    return { tube, rings };
  }
  /**
   * The tool's way on moves between strokes, dashed. moves: of each the joints at its corners,
   * between which they move straight.
   */
  addMoves(moves) {
    const rods = [];
    for (const corners of moves)
      for (let k = 0; k + 1 < corners.length; ++k) {
        const at = (share) =>
          toolPoint(
            this.data.chain,
            corners[k].map((v, j) => v + share * (corners[k + 1][j] - v)),
          );
        let length = 0;
        for (let i = 0; i < 8; ++i) length += at(i / 8).distanceTo(at((i + 1) / 8));
        const dashes = Math.min(60, Math.ceil(length / kDash));
        for (let dash = 0; dash < dashes; ++dash) {
          const from = at(dash / dashes),
            to = at((dash + 0.6) / dashes);
          if (from.distanceTo(to) > 1e-4) rods.push(rodBetween(from, to));
        }
      }
    this.addRods(rods);
  }
  /** Ways of tools, dashed. ways: points of each. */
  addWays(ways) {
    const rods = [];
    for (const way of ways) {
      const points = way.map(vector);
      for (let k = 0, passed = 0; k + 1 < points.length; ++k) {
        const before = Math.floor(passed / kDash);
        passed += points[k].distanceTo(points[k + 1]);
        // A dash is a step, or several of short ones, of every second length.
        if (before % 2 === 0 && points[k].distanceTo(points[k + 1]) > 1e-5)
          rods.push(rodBetween(points[k], points[k + 1]));
      }
    }
    this.addRods(rods);
  }
  /** Rods seen faintly through bodies as well. */
  addRods(rods) {
    if (!rods.length) return;
    const shape = mergeGeometries(rods);
    this.shown.add(
      new THREE.Mesh(shape, surface(kLines.moves, { lit: false })),
      Object.assign(
        new THREE.Mesh(
          shape,
          surface(kLines.moves, { opacity: 0.3, lit: false, depthTest: false }),
        ),
        { renderOrder: 1 },
      ),
    );
  }
  /** The shortest line between two bodies, drawn over everything. */
  addNearest() {
    const material = surface(kLines.nearest, { lit: false, depthTest: false });
    const rod = new THREE.CylinderGeometry(0.0025, 0.0025, 1, 6).rotateX(Math.PI / 2),
      dot = new THREE.SphereGeometry(0.007, 10, 8);
    this.nearest = new THREE.Group();
    this.nearest.add(
      ...[rod, dot, dot].map((shape) =>
        Object.assign(new THREE.Mesh(shape, material), { renderOrder: 1 }),
      ),
    );
    this.nearest.visible = false;
    this.world.add(this.nearest);
  }
  /** A tool's frame: x red, y green, z blue. */
  addTool() {
    const tool = new THREE.Group();
    for (const [axis, colour] of [
      [[1, 0, 0], 0xd62728],
      [[0, 1, 0], 0x2ca02c],
      [[0, 0, 1], 0x1f4fd6],
    ]) {
      const rod = new THREE.Mesh(
        new THREE.CylinderGeometry(0.003, 0.003, 0.07, 6).translate(0, 0.035, 0),
        surface(colour, { lit: false, depthTest: false }),
      );
      rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), vector(axis));
      rod.renderOrder = 2;
      tool.add(rod);
    }
    tool.matrixAutoUpdate = false;
    this.world.add(tool);
    return tool;
  }
  /** The names of the scene's objects and of tools, beside them, and the numbers of strokes. */
  addNames() {
    const objects = new Map();
    for (const { body, rest, fine } of this.parts) {
      if (body.kind !== 'scene') continue;
      fine.computeBoundingBox();
      const box = fine.boundingBox.clone().applyMatrix4(rest);
      objects.set(body.name, objects.has(body.name) ? objects.get(body.name).union(box) : box);
    }
    const labelled = (text, className, at) => {
      const label = document.createElement('span');
      label.className = className;
      label.textContent = text;
      this.gap.parentElement.append(label);
      return { label, at };
    };
    this.toolNames = (this.data.chain.tools ?? []).map(({ name }) =>
      labelled(name, 'name', new THREE.Vector3()),
    );
    // In the order in which they take their places.
    this.names = [
      ...(this.data.numbers ?? []).map(({ text, point }) =>
        labelled(text, 'number', vector(point)),
      ),
      ...this.toolNames,
      ...[...objects].map(([name, box]) => {
        const top = box.getCenter(new THREE.Vector3());
        top.z = Math.min(box.max.z, top.z + 0.25);
        return labelled(name, 'name', top);
      }),
    ];
  }
  /**
   * 'best', 'fit' (from where it is seen now), 'front', 'side', 'top': arm and path into the
   * picture.
   */
  look(from) {
    const shown = subject(this.data, this.parts);
    for (const corner of this.floorCorners ?? []) {
      shown.points.push(corner);
      shown.marks.push({ points: [corner], worth: 2 });
    }
    const direction = {
      front: () => new THREE.Vector3(1, 0, 0.001),
      side: () => new THREE.Vector3(0, -1, 0.001),
      top: () => new THREE.Vector3(-0.001, 0, 1),
      fit: () => this.camera.position.clone().sub(this.orbit.target),
      best: () => bestDirection(shown, this.camera),
    }[from]();
    this.orbit.target.copy(fit(this.camera, shown.points, direction));
    this.orbit.update();
    this.dirty = true;
  }
  /**
   * pair: names of the two bodies that are nearest, or that hit each other, or null; line: { points
   * (six numbers), text } between them, or null. near: returns what is known of how near a body of
   * some name comes to others, lines of text.
   */
  pose(q, pair, line = null, hit = false, near = () => []) {
    const g = displacements(this.data.chain, q);
    this.displaced = g;
    this.told = { pair, text: line?.text, hit, near };
    this.world.matrix.copy(standing(this.data, g));
    for (const mesh of this.arm) {
      const { body, rest } = mesh.userData;
      mesh.matrix.multiplyMatrices(g[body.group], rest);
      const kind = pair?.includes(body.name)
        ? (hit ? 'hit' : 'near') + (body.kind === 'scene' ? ' scene' : '')
        : kindOf(body);
      this.dress(mesh, kind);
    }
    this.hideGhostsOfArm(g);
    toolPoses(this.data.chain, g).forEach((pose, k) => {
      this.tools[k].matrix.copy(pose);
      this.carried[k].matrix.copy(pose);
      this.toolNames[k]?.at.setFromMatrixPosition(pose);
    });
    this.nearest.visible = line !== null;
    this.gap.hidden = line === null;
    if (line) {
      const [rod, ...dots] = this.nearest.children,
        from = vector(line.points.slice(0, 3)),
        to = vector(line.points.slice(3));
      rod.position.lerpVectors(from, to, 0.5);
      rod.quaternion.setFromUnitVectors(
        new THREE.Vector3(0, 0, 1),
        to.clone().sub(from).normalize(),
      );
      rod.scale.z = Math.max(1e-6, from.distanceTo(to));
      dots[0].position.copy(from);
      dots[1].position.copy(to);
      this.gap.textContent = line.text;
    }
    this.dirty = true;
  }
  /** A body in the colours of its kind, as its entry in the legend says. */
  dress(mesh, kind) {
    const { body } = mesh.userData,
      look = this.looks.get(entryOf(body)),
      replaced = body.kind === 'robot' && this.visual.has(body.name) !== Boolean(body.visual);
    mesh.visible = look !== 'hidden' && !replaced;
    mesh.material = (look === 'faded' ? this.faded : this.materials)[kind];
    mesh.userData.kind = kind;
  }
  /** entry: as of entryOf(); look: 'shown', 'faded' or 'hidden'. */
  setLook(entry, look) {
    if (look === 'shown') this.looks.delete(entry);
    else this.looks.set(entry, look);
    for (const mesh of this.arm) this.dress(mesh, mesh.userData.kind ?? kindOf(mesh.userData.body));
    this.dirty = true;
  }
  /** The body under a place of the picture, in pixels, and the point in the frame of what stands on
   * the ground: { body, point }, or null. */
  pick(x, y) {
    const { width, height } = this.size,
      caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    this.scene.updateMatrixWorld();
    const [hit] = caster.intersectObjects(this.arm.filter(({ visible }) => visible));
    return hit ? { body: hit.object.userData.body, point: hit.point } : null;
  }
  /**
   * values: one in 0..1 for each layer of a path, or NaN where nothing is known; path: its number,
   * where there are several.
   */
  colourPath(values, path = 0) {
    const { tube, rings } = this.lines[path],
      count = tube.attributes.position?.count ?? 0,
      colours = new Float32Array(3 * count),
      around = 6; // vertices of a ring: the first again at the end
    for (let k = 0; k < count; ++k) {
      const value = values[Math.round((Math.floor(k / around) / rings) * (values.length - 1))];
      colours.set(
        Number.isNaN(value) || value === undefined ? [0.55, 0.55, 0.55] : ramp(value),
        3 * k,
      );
    }
    tube.setAttribute('color', new THREE.BufferAttribute(colours, 3));
    this.dirty = true;
  }
  /** Takes the colours of the page's theme. */
  paint() {
    this.scene.background = new THREE.Color(isDark() ? '#1a2027' : '#ffffff');
    this.paintGhosts();
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
      for (const mesh of this.arm)
        mesh.geometry = this.quality.coarse ? mesh.userData.coarse : mesh.userData.fine;
      this.resize();
    }
    if (!this.dirty) return false;
    this.dirty = this.moving = false;
    this.renderer.render(this.scene, this.camera);
    this.placeLabels();
    return true;
  }
  /** The picture as it is shown, with the labels: a canvas. */
  picture() {
    const { canvas, scene, camera } = this,
      scale = canvas.width / this.size.width,
      result = document.createElement('canvas'),
      pen = result.getContext('2d');
    this.renderer.render(scene, camera);
    Object.assign(result, { width: canvas.width, height: canvas.height });
    pen.drawImage(canvas, 0, 0);
    pen.scale(scale, scale);
    pen.textBaseline = 'middle';
    // They may be hidden on paper, where this picture has them.
    const named = !canvas.closest('.nameless'),
      labels = [
        ...this.names
          .map(({ label }) => label)
          .filter((one) => (named || one.className !== 'name') && !one.style.visibility),
        ...(this.gap.hidden ? [] : [this.gap]),
      ];
    for (const label of labels) {
      const { color, backgroundColor, font } = getComputedStyle(label),
        [left, top] = label.style.transform.match(/-?[\d.]+/g)?.map(Number) ?? [-99, -99];
      Object.assign(pen, { font, fillStyle: backgroundColor });
      pen.fillRect(left, top, pen.measureText(label.textContent).width + 8, 17);
      pen.fillStyle = color;
      pen.fillText(label.textContent, left + 4, top + 9);
    }
    this.dirty = true;
    return result;
  }
  /** Boxes of the picture, of places along the paths and of the tools, that names leave free. */
  workBoxes() {
    const { width, height } = this.size,
      path = this.data.tool_path ?? [],
      each = Math.max(1, Math.ceil(path.length / kFree.places));
    const box = (point, half) => {
      const at = point.applyMatrix4(this.world.matrix).project(this.camera),
        [x, y] = [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
      return [x - half, y - half, x + half, y + half];
    };
    return [
      ...path.filter((_, k) => k % each === 0).map((point) => box(vector(point), kFree.path)),
      ...this.tools.map(({ matrix: pose }) =>
        box(new THREE.Vector3().setFromMatrixPosition(pose), kFree.tool),
      ),
    ];
  }
  /**
   * The line's length stands where it belongs; numbers of strokes and names, too, or a little above
   * or below, where they cover nothing else. Names stand neither on the path nor
   * on the tool. A name for which there is no room is left out.
   */
  placeLabels() {
    const taken = [],
      work = this.workBoxes();
    const apart = (boxes, [left, top, right, bottom]) =>
        boxes.every(([l, t, r, b]) => right <= l || r <= left || bottom <= t || b <= top),
      isFree = (box) => apart(taken, box),
      isClear = (box) => apart(work, box);
    if (this.nearest.visible)
      taken.push(this.place(this.gap, this.nearest.children[0].position, 12, -26));
    for (const { label, at } of this.names) {
      let box = null;
      for (const down of kAside) {
        box = this.place(label, at, 0, down);
        if (isFree(box) && (label.className !== 'name' || isClear(box))) break;
        box = null;
      }
      if (!box && label.className === 'number') box = this.place(label, at, 0, 0);
      label.style.visibility = box ? '' : 'hidden';
      if (box) taken.push(box);
    }
  }
  /** An element beside a point of the base frame. Returns its left, top, right and bottom. */
  place(element, point, right, down) {
    const at = point.clone().applyMatrix4(this.world.matrix).project(this.camera),
      { width, height } = this.size;
    const x = ((at.x + 1) / 2) * width + right,
      y = ((1 - at.y) / 2) * height + down;
    const { offsetWidth: wide, offsetHeight: high } = element,
      left = Math.round(Math.min(Math.max(4, x), width - wide - 4)),
      top = Math.round(Math.min(Math.max(4, y), height - 24)),
      before = element.className === 'number' ? 9 : 0; // its margin
    element.style.transform = `translate(${left}px, ${top}px)`;
    return [left - before, top - before, left - before + wide, top - before + high];
  }
}

/**
 * Starts the view of a page after its first picture, since WebGL takes longest; where there is
 * none, the page says so. sceneOf: returns what the view shows, as the constructor of View takes
 * it; begin: called with the view once it is there; step: called before every frame with its time,
 * ms, returns whether the arm plays.
 */
export function startView(sceneOf, begin, step) {
  const start = () => {
    let view;
    try {
      view = new View($('scene'), $('gap'), sceneOf());
    } catch (error) {
      $('scene').hidden = $('view-options').hidden = true;
      $('no-view').hidden = false;
      window.swivel.frames = -1;
      return;
    }
    // Not listed with the rest, which tests read as a whole.
    Object.defineProperty(window.swivel, 'view', { value: view });
    view.legend = new BodyList($('bodies'), view);
    offerVisual(view.data);
    keepForPaper(view);
    begin(view);
    const frame = (now) => {
      const playing = step(now);
      if (view.draw(now, playing) && ++window.swivel.frames === 1)
        performance.mark('first picture');
      requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(() => setTimeout(start));
}

/** Shows the switch of the robot's visual shapes where there are some; it says what is missing. */
function offerVisual({ visual, unread }) {
  const option = $('visual-option');
  option.hidden = !visual?.length;
  if (!unread?.length) return;
  option.title = `not shown:\n${unread.join('\n')}`;
  option.append(` (${unread.length} not shown)`);
}

/** Prints the picture of the moment with its labels: a canvas keeps none. */
function keepForPaper(view) {
  addEventListener('beforeprint', () => {
    $('kept').src = view.picture().toDataURL();
    $('kept').hidden = false;
  });
  addEventListener('afterprint', () => ($('kept').hidden = true));
}
