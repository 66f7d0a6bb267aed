// SPDX-License-Identifier: BSD-3-Clause
// What is drawn over the scene: contact forces, what the network believes, the robot's path. Each kind has a switch.
import * as THREE from 'three';
import { tellsTruth } from './moment.js';

export const kForce_m_per_n = 0.0016;
const kSpeed_m_per_mps = 0.25, kTrail_s = 20, kTrailPoints = 800;
export const kColors = { force: '#d8322f', belief: '#f07c12', truth: '#1d5c99' };

const flat = (color, more = {}) => new THREE.MeshBasicMaterial({ color: new THREE.Color(color).convertSRGBToLinear(), ...more });

/** An arrow of unit length along z; `aim` turns and stretches it. */
class Arrow {
  constructor(color, radius) {
    const material = new THREE.MeshStandardMaterial({ color: new THREE.Color(color).convertSRGBToLinear(), roughness: 0.5 });
    this.shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(radius, radius, 1, 14).rotateX(Math.PI / 2).translate(0, 0, 0.5), material);
    this.tip = new THREE.Mesh(new THREE.ConeBufferGeometry(2.4 * radius, 6 * radius, 18).rotateX(Math.PI / 2).translate(0, 0, 3 * radius), material);
    this.tipLength = 6 * radius;
    this.group = new THREE.Group().add(this.shaft, this.tip);
  }

  aim(from, vector) {
    const length = vector.length();
    this.group.visible = length > this.tipLength;  // false for NaN
    if (!this.group.visible) return;
    this.group.position.copy(from);
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), vector.clone().divideScalar(length));
    this.shaft.scale.z = length - 0.9 * this.tipLength;
    this.tip.position.z = length - this.tipLength;
  }
}

/** A band on the ground along the latest seconds of a path. */
class Trail {
  constructor(color, frames, pointAt) {
    this.frames = frames;
    this.pointAt = pointAt;
    this.positions = new Float32Array(6 * kTrailPoints);
    const geometry = this.geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(this.positions, 3));
    const index = [];
    for (let i = 0; i + 1 < kTrailPoints; ++i) index.push(2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3);
    geometry.setIndex(index);
    this.mesh = new THREE.Mesh(geometry, flat(color, { side: THREE.DoubleSide, transparent: true, opacity: 0.75, depthWrite: false }));
    this.mesh.frustumCulled = false;
  }

  show(row) {
    const first = Math.max(0, this.frames.countUntil(this.frames.time(row) - kTrail_s) - 1);
    const every = Math.max(1, Math.ceil((row - first) / (kTrailPoints - 2)));
    let points = 0, before = null;
    for (let i = first; i <= row; i += every) {
      const at = this.pointAt(i);
      if (!at.every(Number.isFinite)) continue;
      const dx = before ? at[0] - before[0] : 0, dy = before ? at[1] - before[1] : 0, step = Math.hypot(dx, dy);
      if (before && step < 0.01) continue;
      const aside = step > 0 ? 0.006 / step : 0;
      this.positions.set([at[0] - aside * dy, at[1] + aside * dx, at[2], at[0] + aside * dy, at[1] - aside * dx, at[2]], 6 * points);
      before = at;
      ++points;
    }
    this.geometry.setDrawRange(0, 6 * Math.max(0, points - 1));
    this.geometry.attributes.position.needsUpdate = true;
  }
}

export class Overlays {
  constructor({ hello, frames }, robot, surface) {
    this.robot = robot;
    this.feet = hello.feet;
    this.hasTruth = tellsTruth(frames);
    this.forces = hello.feet.map(() => new Arrow(kColors.force, 0.008));
    this.rings = hello.feet.map(() => new THREE.Mesh(new THREE.TorusBufferGeometry(0.05, 0.0035, 8, 40), flat(kColors.belief)));
    this.believedSpeed = new Arrow(kColors.belief, 0.008);
    this.trueSpeed = new Arrow(kColors.truth, 0.008);
    const size = robot.baseBox().getSize(new THREE.Vector3());
    this.boxCentre = robot.baseBox().getCenter(new THREE.Vector3());
    const edges = new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(size.x + 0.01, size.y + 0.01, size.z + 0.01));
    this.box = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: new THREE.Color(kColors.belief).convertSRGBToLinear() }));
    const onGround = (x, y) => [x, y, surface.at(x, y) + 0.012];
    this.frames = frames;
    this.beginAnew();
    this.truePath = new Trail(kColors.truth, frames, (i) => onGround(frames.at(i, 'position_m', 0), frames.at(i, 'position_m', 1)));
    this.reckonedPath = new Trail(kColors.belief, frames, (i) => onGround(...this.place(frames.at(i, 'odometry', 0), frames.at(i, 'odometry', 1))));
    const group = (objects) => new THREE.Group().add(...objects);
    this.kinds = {
      force: group(this.forces.map((a) => a.group)),
      belief: group([...this.rings, this.box, this.believedSpeed.group, this.trueSpeed.group]),
      path: group([this.truePath.mesh, this.reckonedPath.mesh]),
    };
    this.kinds.path.children[0].visible = this.hasTruth;
    this.group = group(Object.values(this.kinds));
  }

  /** The frames begin with another one. */
  beginAnew() { this.place = alignment(this.frames); }

  show(moment) {
    const { forces, estimate, truth, hasEstimate, hasTruth } = moment;
    const compares = hasEstimate && hasTruth;
    this.feet.forEach((foot, l) => {
      const at = this.robot.where(foot);
      this.forces[l].aim(at, new THREE.Vector3(...forces.slice(3 * l, 3 * l + 3)).multiplyScalar(kForce_m_per_n));
      this.rings[l].visible = compares;
      this.rings[l].position.set(at.x, at.y, at.z + estimate[4 + l] - truth[4 + l]);
    });
    const { position, quaternion } = this.robot.root;
    this.box.visible = compares;
    this.box.quaternion.copy(quaternion);
    this.box.position.copy(this.boxCentre).applyQuaternion(quaternion).add(position);
    if (compares) this.box.position.z += estimate[0] - truth[0];
    const above = new THREE.Vector3(0, 0, 0.16).add(position);
    const speed = (state) => new THREE.Vector3(...state.slice(1, 4)).applyQuaternion(quaternion).multiplyScalar(kSpeed_m_per_mps);
    this.trueSpeed.aim(above, hasTruth ? speed(truth) : new THREE.Vector3());
    this.believedSpeed.aim(above.setZ(above.z + 0.03), hasEstimate ? speed(estimate) : new THREE.Vector3());
    if (this.kinds.path.visible && moment.row !== this.shown) {
      this.shown = moment.row;
      if (this.hasTruth) this.truePath.show(moment.row);
      this.reckonedPath.show(moment.row);
    }
  }
}

/** Dead reckoning begins at the origin of its own frame: lays its beginning onto the robot's. */
function alignment(frames) {
  if (frames.count === 0) return (x, y) => [x, y];
  const [w, i, j, k] = frames.all(0, 'orientation_wxyz'), [x0, y0, yaw0] = frames.all(0, 'odometry');
  const turn = Math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k)) - yaw0, c = Math.cos(turn), s = Math.sin(turn);
  const [px, py] = frames.all(0, 'position_m');
  return (x, y) => [px + c * (x - x0) - s * (y - y0), py + s * (x - x0) + c * (y - y0)];
}
