// SPDX-License-Identifier: BSD-3-Clause
// The robot as its URDF draws it: boxes, cylinders and spheres. A link with nothing but meshes, which a page has no
// files of, is drawn by its collision shapes, or by rods to its joints.
import * as THREE from 'three';

const numbers = (text, otherwise) => (text ?? otherwise).trim().split(/\s+/).map(Number);

function place(object, origin) {
  const [x, y, z] = numbers(origin?.getAttribute('xyz'), '0 0 0');
  const [roll, pitch, yaw] = numbers(origin?.getAttribute('rpy'), '0 0 0');
  object.position.set(x, y, z);
  object.rotation.set(roll, pitch, yaw, 'ZYX');
}

// A box with its edges taken off: they catch the light.
function box([x, y, z]) {
  const r = Math.min(0.012, 0.2 * Math.min(x, y, z)), a = x / 2 - r, b = y / 2 - r;
  const outline = new THREE.Shape([[-a, -b], [a, -b], [a, b], [-a, b]].map(([u, v]) => new THREE.Vector2(u, v)));
  const geometry = new THREE.ExtrudeBufferGeometry(outline,
    { depth: z - 2 * r, bevelThickness: r, bevelSize: r, bevelSegments: 3, curveSegments: 4 });
  return geometry.translate(0, 0, r - z / 2);
}

function cylinder(radius, length, topRadius = radius) {
  // three's cylinders stand along y, URDF's along z
  return new THREE.CylinderBufferGeometry(topRadius, radius, length, 32).rotateX(Math.PI / 2);
}

function shape(geometry) {
  const g = geometry?.firstElementChild;
  const number = (name) => Number(g.getAttribute(name));
  if (g?.tagName === 'box') return box(numbers(g.getAttribute('size')));
  if (g?.tagName === 'sphere') return new THREE.SphereBufferGeometry(number('radius'), 28, 18);
  if (g?.tagName === 'cylinder') return cylinder(number('radius'), number('length'));
  return null;
}

function rod(end, radius, material) {
  const mesh = new THREE.Mesh(cylinder(radius, end.length()), material);
  mesh.position.copy(end).multiplyScalar(0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), end.clone().normalize());
  return mesh;
}

/** Materials by colour; those of a name are said once in a URDF and used by this name elsewhere. */
class Paint {
  constructor(urdf) {
    this.urdf = urdf;
    this.made = new Map();
  }

  of(visual) {
    const material = visual?.querySelector('material'), name = material?.getAttribute('name');
    const named = name && [...this.urdf.querySelectorAll('material')]
      .find((m) => m.getAttribute('name') === name && m.querySelector('color'));
    const rgba = ((material?.querySelector('color') ? material : named)?.querySelector('color'))?.getAttribute('rgba');
    const key = rgba ?? '0.35 0.38 0.42 1';
    if (!this.made.has(key)) {
      const [r, g, b] = numbers(key);
      const color = new THREE.Color(r, g, b).convertSRGBToLinear();
      this.made.set(key, new THREE.MeshStandardMaterial({ color, roughness: 0.5, metalness: 0.15 }));
    }
    return this.made.get(key);
  }
}

export class Robot {
  /** @param {string} text URDF  @param {string} base link whose pose frames give  @param {string[]} joints in order */
  constructor(text, base, joints) {
    const urdf = new DOMParser().parseFromString(text, 'application/xml');
    const paint = new Paint(urdf);
    const links = new Map();
    for (const link of urdf.querySelectorAll('robot > link')) links.set(link.getAttribute('name'), this.#link(link, paint));
    this.joints = joints.map(() => null);
    this.limits = joints.map(() => null);
    for (const joint of urdf.querySelectorAll('robot > joint')) this.#hang(joint, links, joints, paint);
    this.links = links;
    this.root = links.get(base) ?? new THREE.Group();
    this.root.parent?.remove(this.root);
    this.root.traverse((o) => { if (o.isMesh) o.castShadow = o.receiveShadow = true; });
  }

  #link(link, paint) {
    const frame = new THREE.Group();
    frame.name = link.getAttribute('name');
    for (const kind of ['visual', 'collision']) {
      for (const drawn of link.querySelectorAll(kind)) {
        const geometry = shape(drawn.querySelector('geometry'));
        if (!geometry) continue;
        const mesh = new THREE.Mesh(geometry, paint.of(drawn));
        place(mesh, drawn.querySelector('origin'));
        frame.add(mesh);
      }
      if (frame.children.length) break;
    }
    frame.userData.bare = frame.children.length === 0;
    return frame;
  }

  #hang(joint, links, names, paint) {
    const link = (tag) => links.get(joint.querySelector(tag)?.getAttribute('link'));
    const parent = link('parent'), child = link('child');
    if (!parent || !child) return;
    const place_ = new THREE.Group(), turning = new THREE.Group();
    place(place_, joint.querySelector('origin'));
    if (parent.userData.bare && place_.position.length() > 0.02) parent.add(rod(place_.position, 0.02, paint.of(null)));
    parent.add(place_);
    place_.add(turning);
    turning.add(child);
    const number = names.indexOf(joint.getAttribute('name'));
    if (number < 0) return;
    const axis = new THREE.Vector3(...numbers(joint.querySelector('axis')?.getAttribute('xyz'), '1 0 0')).normalize();
    this.joints[number] = { turning, axis };
    const limit = joint.querySelector('limit');
    this.limits[number] = { torque: Number(limit?.getAttribute('effort')), speed: Number(limit?.getAttribute('velocity')) };
  }

  /** Takes the pose of a moment; what is not a number there stays as it was. */
  pose({ position, orientation, joints }) {
    if (position.every(Number.isFinite)) this.root.position.set(...position);
    const [w, x, y, z] = orientation;
    if (orientation.every(Number.isFinite)) this.root.quaternion.set(x, y, z, w);
    this.joints.forEach((joint, j) => {
      if (joint && Number.isFinite(joints[j])) joint.turning.quaternion.setFromAxisAngle(joint.axis, joints[j]);
    });
    this.root.updateMatrixWorld(true);
  }

  /** Where the origin of a link is, world frame. */
  where(link, target = new THREE.Vector3()) {
    return target.setFromMatrixPosition((this.links.get(link) ?? this.root).matrixWorld);
  }

  /** The box around the base's own shapes, in its frame. */
  baseBox() {
    const bounds = new THREE.Box3();
    const visit = (group) => {
      for (const o of group.children) {
        if (!o.isMesh) continue;
        o.updateMatrix();
        o.geometry.computeBoundingBox();
        bounds.union(o.geometry.boundingBox.clone().applyMatrix4(o.matrix));
      }
    };
    visit(this.root);
    // ROS's base_link is often an empty link at the same place as the base itself.
    if (bounds.isEmpty()) this.root.children.forEach((place_) => place_.children.forEach((t) => t.children.forEach(visit)));
    return bounds.isEmpty() ? new THREE.Box3(new THREE.Vector3(-0.3, -0.15, -0.08), new THREE.Vector3(0.3, 0.15, 0.08)) : bounds;
  }
}
