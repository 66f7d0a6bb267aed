// SPDX-License-Identifier: BSD-3-Clause
// The robot's state in words and figures, over the scene.

const fixed = (value, digits) => {
  const text = Number.isFinite(value) ? value.toFixed(digits) : '?';
  return /^-0\.?0*$/.test(text) ? text.slice(1) : text;
};

export class State {
  constructor(hello, hasTruth) {
    this.hello = hello;
    const element = (id) => document.getElementById(id);
    this.parts = Object.fromEntries(['mode', 'clock', 'speed', 'requested', 'faults', 'sinkage'].map((id) => [id, element(id)]));
    element('note').textContent = hello.note;
    document.title = ['Sandrunner', hello.robot, hello.terrain].filter(Boolean).join(', ');
    if (!hasTruth) return;
    const title = document.createElement('h2');
    title.textContent = 'sinkage, mm';
    this.parts.sinkage.append(title);
    this.depths = hello.legs.map((leg) => {
      const cell = document.createElement('span'), depth = document.createElement('b');
      cell.append(leg, depth);
      this.parts.sinkage.append(cell);
      return depth;
    });
  }

  show({ t, mode, motion, estimate, hasTruth, hasEstimate, requested, given, penetration, faults, warnings, skipped }) {
    const name = this.hello.modes[mode] ?? `mode ${mode}`, { parts } = this;
    parts.mode.textContent = name.replace('_', ' ');
    parts.mode.className = name;
    parts.clock.textContent = `${fixed(t, 2)} s${skipped ? `, ${skipped} ticks skipped` : ''}`;
    const speed = hasTruth ? motion[0] : hasEstimate ? estimate[1] : NaN;
    parts.speed.innerHTML = `${fixed(speed, 2)} <small>m/s${hasTruth ? '' : ', estimated'}</small>`;
    const text = (command) => `${fixed(command[0], 1)}, ${fixed(command[1], 1)} m/s, ${fixed(command[2], 1)} rad/s`;
    const differs = name === 'walk' && requested.some((v, k) => Math.abs(v - given[k]) > 0.05);
    parts.requested.textContent = `commanded ${text(requested)}${differs ? `; limited to ${text(given)}` : ''}`;
    const set = (names, bits) => names.filter((_, bit) => (bits >>> bit) & 1);
    const found = set(this.hello.faults, faults).map((f) => `${f.name}: ${f.meaning}`);
    const warned = set(this.hello.warnings, warnings).map((warning) => `${warning}: it lies down`);
    parts.faults.textContent = [...found, ...warned].join('; ');
    this.depths?.forEach((b, l) => { b.textContent = fixed(Math.max(0, 1000 * penetration[l]), 0); });
  }
}
