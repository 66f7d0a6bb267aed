// SPDX-License-Identifier: BSD-3-Clause
// The robot from its right side on a plain canvas, for browsers without WebGL: as side_view.cpp draws it.
import * as THREE from 'three';
import { kForce_m_per_n } from './overlays.js';
import { context2d } from './plots.js';

// What lies to the left is drawn further to the front and up, so that left legs do not hide behind right ones.
const kAheadPerLeft = 0.24, kUpPerLeft = 0.12, kWidth_m = 1.7, kBelow_m = 0.33;
const kHip_m = 0.17;  // of the legs from the middle, about
const kSteepness = Math.sqrt(3);  // walls of 60 degrees

export class SideView {
  constructor(canvas, { hello, footprints }, robot, surface) {
    Object.assign(this, { canvas, hello, footprints, robot, surface });
    this.box = robot.baseBox();
    // The chain of each leg: where its joints are, then the foot.
    this.chains = hello.legs.map((_, l) => [
      ...[1, 2].map((k) => robot.joints[3 * l + k]?.turning).filter(Boolean), robot.links.get(hello.feet[l])].filter(Boolean));
  }

  draw(moment) {
    const { g, width, height } = context2d(this.canvas);
    const scale = Math.min(width / kWidth_m, height / 1.0), { position } = this.robot.root;
    const forward = new THREE.Vector3(1, 0, 0).applyQuaternion(this.robot.root.quaternion).setZ(0).normalize();
    const view = ({ x, y, z }) => {
      const dx = x - position.x, dy = y - position.y, left = forward.x * dy - forward.y * dx;
      return { u: forward.x * dx + forward.y * dy + kAheadPerLeft * left, v: left, z: z + kUpPerLeft * left };
    };
    const floor = this.surface.at(position.x, position.y);
    const px = (u) => width / 2 + scale * u, py = (z) => height - scale * (z - floor + kBelow_m);
    const groundAt = (u, v) => this.surface.at(position.x + forward.x * u - forward.y * v, position.y + forward.y * u + forward.x * v);
    const sky = g.createLinearGradient(0, 0, 0, height);
    sky.addColorStop(0, '#b9d2e8');
    sky.addColorStop(1, '#e6eef4');
    g.fillStyle = sky;
    g.fillRect(0, 0, width, height);
    for (const far of [true, false]) {
      this.#ground(g, moment, far, view, px, py, groundAt, width, height, scale);
      if (far) this.#legs(g, 0, '#7899ba', view, px, py, scale);
    }
    this.#body(g, view, px, py);
    this.#legs(g, 1, '#1a3354', view, px, py, scale);
    this.#forces(g, moment, view, px, py);
  }

  #ground(g, moment, far, view, px, py, groundAt, width, height, scale) {
    const holes = [], until = this.footprints.count ? this.footprints.countUntil(moment.t) : 0;
    const add = (x, y, depth) => {
      const p = view({ x, y, z: 0 });
      if ((p.v > 0) === far && Math.abs(p.v) < 0.45 && depth > 0) holes.push({ u: p.u, depth });
    };
    for (let i = Math.max(0, until - 200); i < until; ++i) {
      add(this.footprints.at(i, 'x_m'), this.footprints.at(i, 'y_m'), this.footprints.at(i, 'depth_m'));
    }
    for (let l = 0; l < 4; ++l) add(...moment.stance.slice(3 * l, 3 * l + 3));
    const left = (far ? 1 : -1) * kHip_m, radius = this.hello.foot_radius_m;
    const surface = new Path2D();
    for (let x = -2; x <= width + 2; ++x) {
      const u = (x - width / 2) / scale;
      let depth = 0;
      for (const hole of holes) depth = Math.max(depth, hole.depth - Math.max(0, Math.abs(u - hole.u) - radius) * kSteepness);
      surface.lineTo(x, py(groundAt(u - kAheadPerLeft * left, left) + kUpPerLeft * left - depth));
    }
    const below = new Path2D(surface);
    below.lineTo(width + 2, height + 2);
    below.lineTo(-2, height + 2);
    g.fillStyle = this.hello.granular ? (far ? '#ccad75' : '#e6cc99') : (far ? '#b8bac2' : '#ccced4');
    g.strokeStyle = this.hello.granular ? '#997840' : '#737880';
    g.lineWidth = far ? 1 : 2;
    g.fill(below);
    g.stroke(surface);
  }

  #legs(g, first, color, view, px, py, scale) {
    g.lineCap = 'round';
    g.strokeStyle = g.fillStyle = color;
    for (let l = first; l < 4; l += 2) {
      const points = this.chains[l].map((o) => view(new THREE.Vector3().setFromMatrixPosition(o.matrixWorld)));
      points.slice(1).forEach((to, k) => {
        g.lineWidth = scale * (k === 0 ? 0.058 : 0.026);
        g.beginPath();
        g.moveTo(px(points[k].u), py(points[k].z));
        g.lineTo(px(to.u), py(to.z));
        g.stroke();
      });
      points.forEach(({ u, z }, k) => {
        g.beginPath();
        g.arc(px(u), py(z), scale * [0.046, 0.03, this.hello.foot_radius_m][k], 0, 2 * Math.PI);
        g.fill();
      });
    }
  }

  #body(g, view, px, py) {
    const { min, max } = this.box;
    const corner = (i) => view(new THREE.Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z)
      .applyMatrix4(this.robot.root.matrixWorld));
    const corners = [...Array(8).keys()].map(corner);
    for (const face of [[0, 2, 6, 4], [1, 3, 7, 5], [2, 3, 7, 6], [4, 5, 7, 6], [0, 1, 5, 4]]) {
      g.beginPath();
      for (const i of face) g.lineTo(px(corners[i].u), py(corners[i].z));
      g.closePath();
      g.fillStyle = face.includes(6) ? '#f2a14d' : '#ed8521';
      g.strokeStyle = '#994d0d';
      g.lineWidth = 1.5;
      g.fill();
      g.stroke();
    }
  }

  #forces(g, { forces }, view, px, py) {
    g.strokeStyle = '#d8322f';
    g.lineWidth = 4;
    this.hello.feet.forEach((foot, l) => {
      const at = this.robot.where(foot), force = new THREE.Vector3(...forces.slice(3 * l, 3 * l + 3)).multiplyScalar(kForce_m_per_n);
      if (!(force.length() > 0.02)) return;
      const from = view(at), to = view(at.clone().add(force));
      g.beginPath();
      g.moveTo(px(from.u), py(from.z));
      g.lineTo(px(to.u), py(to.z));
      g.stroke();
    });
  }

  /** Where a way in the picture goes, rad from world x: forward or back. */
  directionOf(dx) {
    const forward = new THREE.Vector3(1, 0, 0).applyQuaternion(this.robot.root.quaternion);
    return Math.atan2(forward.y, forward.x) + (dx < 0 ? Math.PI : 0);
  }

  picture(done) { this.canvas.toBlob(done, 'image/png'); }
}
