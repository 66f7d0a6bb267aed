// SPDX-License-Identifier: BSD-3-Clause
// The scene in WebGL: robot, ground, light, and a camera that follows.
import * as THREE from 'three';
import { OrbitControls } from 'three-examples/controls/OrbitControls.js';
import { Ground } from './ground.js';
import { Heights } from './heights.js';
import { Overlays } from './overlays.js';

const kHorizon = new THREE.Color(0xdbe6ee).convertSRGBToLinear(), kZenith = new THREE.Color(0x8fb4d6).convertSRGBToLinear();
const kFirstView = new THREE.Vector3(1.25, -1.75, 0.62), kLookAt_m = 0.27;
// What is given up, one after the other, while the machine draws fewer than 20 pictures a second.
const kQualities = [{ pixels: 2, shadow: 2048 }, { pixels: 1, shadow: 1024 }, { pixels: 0.75, coarse: true }, { pixels: 0.5, coarse: true }];
const kSlow_ms = 50, kPatience = 12;  // pictures in a row

function sky() {
  const material = new THREE.ShaderMaterial({
    uniforms: { low: { value: kHorizon }, high: { value: kZenith } },
    vertexShader: 'varying vec3 way; void main() { way = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
    fragmentShader: `uniform vec3 low; uniform vec3 high; varying vec3 way;
      void main() { gl_FragColor = vec4(pow(mix(low, high, smoothstep(0.0, 0.55, normalize(way).z)), vec3(1.0 / 2.2)), 1.0); }`,
    side: THREE.BackSide, depthWrite: false, fog: false,
  });
  const mesh = new THREE.Mesh(new THREE.SphereBufferGeometry(80, 24, 16), material);
  mesh.frustumCulled = false;
  return mesh;
}

export class Scene {
  /** Throws if there is no WebGL 2. */
  constructor(canvas, run, robot, surface, quality = 0) {
    const context = canvas.getContext('webgl2', { antialias: true });
    if (!context) throw new Error('no WebGL 2');
    this.canvas = canvas;
    this.robot = robot;
    const renderer = this.renderer = new THREE.WebGLRenderer({ canvas, context });
    renderer.gammaOutput = true;
    renderer.gammaFactor = 2.2;
    renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    const scene = this.scene = new THREE.Scene();
    scene.fog = new THREE.Fog(0, 5, 26);
    scene.fog.color.copy(kHorizon).convertLinearToSRGB();  // three mixes fog in behind the conversion
    this.camera = new THREE.PerspectiveCamera(36, 1, 0.05, 120);
    this.camera.up.set(0, 0, 1);
    this.surface = surface;
    this.heights = new Heights(run, surface);
    this.ground = new Ground(this.heights, run.hello.granular);
    this.overlays = new Overlays(run, robot, surface);
    this.sky = sky();
    const sun = this.sun = new THREE.DirectionalLight(0xfff0d8, 1.08);
    Object.assign(sun.shadow.camera, { left: -1.3, right: 1.3, top: 1.3, bottom: -1.3, near: 0.5, far: 8 });
    sun.shadow.bias = -0.0008;
    scene.add(robot.root, this.ground.mesh, this.overlays.group, this.sky, sun, sun.target,
      new THREE.HemisphereLight(0xdfeaff, 0xa58a5c, 0.55));
    this.controls = new OrbitControls(this.camera, canvas);
    Object.assign(this.controls, { enableKeys: false, minDistance: 0.5, maxDistance: 9, maxPolarAngle: 1.54 });
    this.focus = new THREE.Vector3(0, 0, kLookAt_m);
    this.#setQuality(quality);
    this.resetCamera();
    this.slow = 0;
  }

  /** Squares of ground, m, that are known now; their heights are in the surface already. */
  groundCame(squares) { for (const square of squares) this.heights.groundCame(square); }

  /** Sand, or something hard. */
  groundIsSoft(soft) { this.ground.setSoft(soft); }

  /** Where on the ground, rad from world x, a way in the picture goes, pixels right and down. */
  directionOf(dx, dy) {
    const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    return Math.atan2(right.y, right.x) + Math.atan2(-dy, dx);
  }

  /** The frames are another run's. */
  beginAnew() { this.overlays.beginAnew(); }

  resetCamera() {
    this.controls.target.copy(this.focus);
    // A narrow window needs more distance to hold the robot.
    const aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
    this.camera.position.copy(kFirstView).multiplyScalar(Math.max(1, 1.15 / aspect)).add(this.focus);
  }

  /**
   * @param {object} moment of moment.js; its robot has taken the pose already
   * @param {number} took_ms from the picture before to this one; 0: there was a pause
   */
  draw(moment, took_ms = 0) {
    const { renderer, canvas } = this;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    const { x, y, z } = this.robot.root.position;
    this.heights.show(moment.t, x, y, moment.stance);
    this.ground.follow(renderer, x, y);
    this.overlays.show(moment);
    const floor = this.surface.at(x, y);
    const focus = new THREE.Vector3(x, y, floor + kLookAt_m + Math.max(0, z - floor - 0.9));
    this.camera.position.add(focus.clone().sub(this.focus));
    this.controls.target.add(focus.clone().sub(this.focus));
    this.focus = focus;
    this.sun.position.set(x - 1.7, y - 1.5, floor + 2.4);
    this.sun.target.position.set(x, y, floor + 0.1);
    this.controls.update();
    this.sky.position.copy(this.camera.position);
    const size = renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height) {
      renderer.setSize(width, height, false);
      this.camera.aspect = width / Math.max(1, height);
      this.camera.updateProjectionMatrix();
    }
    renderer.render(this.scene, this.camera);
    this.#keepUp(took_ms);
  }

  /** The picture as a PNG blob. */
  picture(done) {
    this.renderer.render(this.scene, this.camera);
    this.canvas.toBlob(done, 'image/png');
  }

  #setQuality(quality) {
    this.quality = quality;
    const { pixels, shadow, coarse } = kQualities[quality];
    this.renderer.setPixelRatio(Math.min(pixels, window.devicePixelRatio * Math.min(1, pixels)));
    this.renderer.shadowMap.enabled = this.sun.castShadow = Boolean(shadow);
    this.sun.shadow.mapSize.set(shadow ?? 16, shadow ?? 16);
    this.sun.shadow.map?.dispose();
    this.sun.shadow.map = null;
    this.scene.traverse((o) => { if (o.material) o.material.needsUpdate = true; });
    if (coarse) this.ground.coarsen();
  }

  #keepUp(took_ms) {
    this.slow = took_ms > kSlow_ms ? this.slow + 1 : 0;
    if (this.slow < kPatience || this.quality + 1 === kQualities.length) return;
    this.slow = 0;
    this.#setQuality(this.quality + 1);
  }
}
