// SPDX-License-Identifier: BSD-3-Clause
// What a page does to a simulated robot and its ground: pushes it, sets it on its legs, makes the sand softer. Ranges and
// refusals are the server's; the sliders span what is of use, the fields beside them take the rest.
const element = (id) => document.getElementById(id);
const kShortestDrag_px = 15;

// Names of the sliders, keys of [terrain] for each kind of ground, the first of which is shown, in which unit; `log`: the
// slider is one of powers of ten.
const kSliders = [
  { name: 'stiffness', log: true, keys: { granular: ['sigma_flat_npm3', 'sigma_cone_npm3'], linear: ['stiffness_npm'] },
    unit: { granular: 'N/m³', linear: 'N/m' }, from: { granular: 4, linear: 3 }, to: { granular: 8, linear: 6 } },
  { name: 'friction', keys: { granular: ['friction'], linear: ['friction'], rigid: ['friction'] }, to: 2, step: 0.01 },
  { name: 'strength', log: true, keys: { mud: ['strength_pa'] }, unit: { mud: 'Pa' }, from: { mud: 2 }, to: { mud: 4.4 } },
  { name: 'suction', keys: { mud: ['suction'] }, to: 1, step: 0.01 },
  { name: 'drag', keys: { granular: ['drag'] }, to: 100, step: 0.1 },
  { name: 'packing', keys: { granular: ['packing'] }, to: 1, step: 0.01 },
];

export class SceneControls {
  /** @param {Function} onKind receives whether the ground is drawn as sand, when it has become of another kind */
  constructor(live, frames, view, onKind) {
    Object.assign(this, { live, frames, view, onKind });
    this.sliders = kSliders.map((slider) => this.#makeSlider(slider));
    element('preset').onchange = () => this.#say({ say: 'terrain', preset: element('preset').value, set: {} });
    element('push').onclick = () => this.#push(this.#heading() + Math.PI / 2);
    element('on-legs').onclick = () => this.#say({ say: 'set_on_legs' });
    this.#dragToPush();
  }

  get allowed() { return Boolean(this.live.state.ground) && this.live.mayTouch && !this.live.state.ended; }

  /** After each state that the server told. */
  show() {
    const { ground } = this.live.state;
    element('touch').hidden = element('ground').hidden = !this.allowed;
    if (!ground) return;
    if (this.kind !== ground.kind) {
      this.kind = ground.kind;
      this.onKind(ground.granular);
    }
    element('ground-name').textContent = ground.name;
    const presets = ['', ...ground.presets];
    if (element('preset').options.length !== presets.length) {
      element('preset').replaceChildren(...presets.map((name) => new Option(name || 'as it began', name)));
    }
    if (document.activeElement !== element('preset')) element('preset').value = ground.preset;
    for (const show of this.sliders) show(ground);
  }

  #say(message) {
    element('refusal').textContent = '';
    this.live.say(message);
  }

  #makeSlider({ name, log, keys, unit, from, to, step }) {
    const row = document.createElement('label'), label = document.createElement('span');
    const range = document.createElement('input'), field = document.createElement('input');
    range.type = 'range';
    field.type = 'number';
    field.step = range.step = 'any';
    range.name = name;
    field.name = field.ariaLabel = `${name} as a number`;
    row.append(label, range, field);
    element('sliders').append(row);
    const value = () => (log ? Number((10 ** Number(range.value)).toPrecision(2)) : Math.round(Number(range.value) / step) * step);
    const set = (wanted) => {
      const { preset, set: before, kind, values } = this.live.state.ground, [first, ...others] = keys[kind];
      if (!Number.isFinite(wanted)) return;
      const now = { ...before, [first]: Number(wanted.toPrecision(6)) };
      for (const key of others) now[key] = Number((values[key] * wanted / values[first]).toPrecision(6));
      this.#say({ say: 'terrain', preset, set: now });
    };
    range.oninput = () => { field.value = String(Number(value().toPrecision(6))); };
    range.onchange = () => set(value());
    field.onkeydown = ({ key }) => { if (key === 'Enter') field.blur(); };
    field.onchange = () => set(field.value === '' ? NaN : Number(field.value));
    return ({ kind, values }) => {
      row.hidden = !keys[kind];
      if (row.hidden || row.contains(document.activeElement)) return;
      const now = values[keys[kind][0]];
      label.textContent = unit ? `${name}, ${unit[kind]}` : name;
      range.min = from?.[kind] ?? 0;
      range.max = to[kind] ?? to;
      range.value = log ? Math.log10(now) : now;
      field.value = String(now);
    };
  }

  #push(direction) {
    this.#say({ say: 'push', direction: Math.atan2(Math.sin(direction), Math.cos(direction)) });
  }

  /** Where the robot looks to now, rad from world x. */
  #heading() {
    const [w, x, y, z] = this.frames.all(this.frames.count - 1, 'orientation_wxyz');
    return Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  }

  // With shift, in the scene: the robot is pushed to where the pointer goes.
  #dragToPush() {
    const canvas = element('scene'), line = element('push-line');
    let from = null;
    const way = (event) => [event.clientX - from.x, event.clientY - from.y];
    // The camera's controls listen to the canvas itself.
    for (const kind of ['pointerdown', 'mousedown']) {
      window.addEventListener(kind, (event) => {
        if (!event.shiftKey || event.button !== 0 || event.target !== canvas || !this.allowed) return;
        event.stopImmediatePropagation();
        event.preventDefault();
        from = { x: event.clientX, y: event.clientY };
      }, { capture: true });
    }
    window.addEventListener('pointermove', (event) => {
      if (!from) return;
      const [dx, dy] = way(event);
      line.hidden = false;
      line.style.left = `${from.x}px`;
      line.style.top = `${from.y}px`;
      line.style.width = `${Math.hypot(dx, dy)}px`;
      line.style.transform = `rotate(${Math.atan2(dy, dx)}rad)`;
    });
    window.addEventListener('pointerup', (event) => {
      if (!from) return;
      const [dx, dy] = way(event);
      from = null;
      line.hidden = true;
      if (Math.hypot(dx, dy) >= kShortestDrag_px) this.#push(this.view.directionOf(dx, dy));
    });
    window.addEventListener('pointercancel', () => {
      from = null;
      line.hidden = true;
    });
  }
}
