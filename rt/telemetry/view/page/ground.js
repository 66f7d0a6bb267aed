// SPDX-License-Identifier: BSD-3-Clause
// The ground: a sheet to the horizon that moves with the robot, fine where it is. A texture of heights (heights.js)
// displaces it near the robot and lights it, so that holes are crisp on a mesh that is coarser than they are.
import * as THREE from 'three';
import { inTexture, kSide, kWindow_m } from './heights.js';

const kStep_m = 0.032;  // the sheet moves by its cells, so that its lines stay where they are

// Distances from the middle to the lines of the sheet: even where the robot is, then ever farther apart.
function lines(cell, growth) {
  const side = [];
  for (let at = 0, step = cell; at < 70; at += step) {
    side.push(at);
    if (at >= 1.28) step *= growth;
  }
  return [...side.slice(1).reverse().map((v) => -v), ...side];
}

function sheet(cell, growth) {
  const at = lines(cell, growth), n = at.length;
  const geometry = new THREE.PlaneBufferGeometry(1, 1, n - 1, n - 1), position = geometry.attributes.position;
  for (let j = 0; j < n; ++j) for (let i = 0; i < n; ++i) position.setXYZ(j * n + i, at[i], at[n - 1 - j], 0);
  return geometry;
}

// Noise that tiles, in four channels; the same in every browser.
function noise() {
  const n = 256, data = new Uint8Array(4 * n * n);
  let state = 1;
  for (let i = 0; i < data.length; ++i) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    data[i] = state >>> 24;
  }
  const texture = new THREE.DataTexture(data, n, n, THREE.RGBAFormat);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.magFilter = THREE.LinearFilter;
  texture.minFilter = THREE.LinearMipMapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}

const kDeclare = `
uniform sampler2D heights;
uniform sampler2D grains;
uniform vec2 middle;
uniform float soft;
uniform float uneven;
uniform vec2 plane;
varying vec2 vWorld;
float heightAt(vec2 p) { return texture2D(heights, p / ${kWindow_m.toFixed(4)}).r; }
float within(float from, float to) { vec2 d = abs(vWorld - middle); return 1.0 - smoothstep(from, to, max(d.x, d.y)); }
`;
// Grain, darker holes, metre lines; comes before the normal in three's shader. PLAIN: for slow machines.
const kColor = `
vec4 fine = texture2D(grains, vWorld * 0.33);
#ifdef PLAIN
vec4 coarse = fine, grain = fine, patches = vec4(0.5), speckle = fine;
#else
vec4 coarse = texture2D(grains, vWorld * 0.035), grain = texture2D(grains, vWorld * 1.7);
vec4 patches = texture2D(grains, vWorld * 0.011), speckle = texture2D(grains, vWorld * 3.1);
#endif
float seen = within(4.2, 4.9);
if (soft > 0.5) diffuseColor.rgb *= 0.86 + 0.13 * patches.z + 0.16 * speckle.z * speckle.w + 0.07 * patches.w;
else diffuseColor.rgb *= 0.95 + 0.06 * speckle.z;
diffuseColor.rgb *= 1.0 + soft * seen * clamp(heightAt(vWorld) * 6.5, -0.42, 0.08);
vec2 metre = abs(fract(vWorld + 0.5) - 0.5), wide = max(fwidth(vWorld), vec2(0.003));
vec2 mark = 1.0 - smoothstep(vec2(0.0), 2.0 * wide, metre);
diffuseColor.rgb *= 1.0 - 0.13 * max(mark.x, mark.y) * min(1.0, 0.012 / max(wide.x, wide.y));
`;
const kNormal = `
const float e = 0.006;
vec2 slope = plane + seen * vec2(heightAt(vWorld + vec2(e, 0.0)) - heightAt(vWorld - vec2(e, 0.0)),
                         heightAt(vWorld + vec2(0.0, e)) - heightAt(vWorld - vec2(0.0, e))) / (2.0 * e);
if (soft > 0.5) slope += 0.30 * (coarse.xy - 0.5) + 0.22 * (fine.xy - 0.5) + 0.20 * (grain.xy - 0.5);
else slope += 0.03 * (grain.xy - 0.5);
vec3 normal = normalize((viewMatrix * vec4(normalize(vec3(-slope, 1.0)), 0.0)).xyz);
vec3 geometryNormal = normal;
`;

export class Ground {
  /** @param {Heights} heights  @param {boolean} soft sand, else something hard */
  constructor(heights, soft) {
    this.heights = heights;
    this.texture = new THREE.DataTexture(heights.texels, kSide, kSide, THREE.RedFormat, THREE.HalfFloatType,
      THREE.UVMapping, THREE.RepeatWrapping, THREE.RepeatWrapping, THREE.LinearFilter, THREE.LinearFilter);
    this.texture.needsUpdate = true;
    this.middle = new THREE.Vector2();
    const material = new THREE.MeshPhongMaterial({ shininess: 0, specular: 0 });
    this.grains = noise();
    this.uneven = { value: 0 };
    const uniforms = { uneven: this.uneven, heights: { value: this.texture }, grains: { value: this.grains }, middle: { value: this.middle }, soft: { value: 1 }, plane: { value: new THREE.Vector2(...heights.surface.slope) } };
    // A flat sheet that only looks uneven beyond the fine part; ground with waves is displaced as far as it is known.
    const displaced = '(soft > 0.5 && uneven < 0.5 ? within(1.2, 1.6) : within(4.2, 4.9))';
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, uniforms);
      shader.vertexShader = kDeclare + shader.vertexShader.replace('#include <begin_vertex>', `#include <begin_vertex>
        vWorld = (modelMatrix * vec4(transformed, 1.0)).xy;
        transformed.z += dot(plane, vWorld) + ${displaced} * heightAt(vWorld);`);
      shader.fragmentShader = kDeclare + shader.fragmentShader
        .replace('#include <normal_fragment_begin>', kNormal).replace('#include <color_fragment>', kColor);
    };
    this.mesh = new THREE.Mesh(sheet(0.016, 1.14), material);
    this.mesh.receiveShadow = true;
    this.mesh.frustumCulled = false;
    this.setSoft = (is) => {
      uniforms.soft.value = is ? 1 : 0;
      material.color.set(is ? 0xd9bd8e : 0xaeb4ba).convertSRGBToLinear();
    };
    this.setSoft(soft);
  }

  /** For slow machines. */
  coarsen() {
    this.mesh.geometry.dispose();
    this.mesh.geometry = sheet(0.064, 1.3);
    this.grains.anisotropy = 1;
    this.grains.needsUpdate = true;
    this.mesh.material.defines = { PLAIN: '' };
    this.mesh.material.needsUpdate = true;
  }

  /** Brings the heights to the graphics card and the sheet to x, y. */
  follow(renderer, x, y) {
    this.mesh.position.set(Math.round(x / kStep_m) * kStep_m, Math.round(y / kStep_m) * kStep_m, 0);
    this.middle.set(x, y);
    this.uneven.value = this.heights.surface.flat ? 0 : 1;
    const changed = this.heights.changed.splice(0);
    const handle = renderer.properties.get(this.texture).__webglTexture;
    if (!handle) return;  // not there yet: it comes whole
    const gl = renderer.getContext();
    renderer.state.bindTexture(gl.TEXTURE_2D, handle);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
    gl.pixelStorei(gl.UNPACK_ROW_LENGTH, kSide);
    for (const [left, bottom, width, height] of changed.flatMap(inTexture)) {
      gl.pixelStorei(gl.UNPACK_SKIP_PIXELS, left);
      gl.pixelStorei(gl.UNPACK_SKIP_ROWS, bottom);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, left, bottom, width, height, gl.RED, gl.HALF_FLOAT, this.heights.texels);
    }
    for (const name of ['UNPACK_ROW_LENGTH', 'UNPACK_SKIP_PIXELS', 'UNPACK_SKIP_ROWS']) gl.pixelStorei(gl[name], 0);
  }
}
