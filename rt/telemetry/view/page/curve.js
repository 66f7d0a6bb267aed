// SPDX-License-Identifier: BSD-3-Clause
// The learning curve above the run of a training's policy: a chart for each of its figures. The pointer reads the values
// of one time in all of them; without it they are the newest.
import { Strip } from './plots.js';
import { Table } from './table.js';
import { kTheme } from './theme.js';

const kColors = [kTheme.blue, kTheme.orange];
const figure = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(3))) : '?');

/** @param {object} curve as view_page.h has it */
export function showCurve({ title, x_label, x, every, charts }) {
  const table = new Table(x.length, { t_s: [x] }), last = x.length - 1;
  const section = document.createElement('section'), head = document.createElement('h1'), grid = document.createElement('div');
  section.id = 'curve';
  section.append(head, grid);
  document.body.prepend(section);
  document.body.classList.add('training');
  const strips = charts.map((chart) => {
    const lines = chart.lines.map(({ name, values }, k) => ({ label: name, color: kColors[k], value: (i) => values[i] ?? NaN }));
    return new Strip(grid, chart.title, chart.unit, lines, { least: 1e-3, marks: ' M' });
  });
  let row = last;
  const draw = () => {
    const means = every > 1 ? `, means of ${every} updates` : '';
    head.textContent = row === last ? `${title}.` : `At ${figure(x[row])} ${x_label}${means}.`;
    for (const strip of strips) {
      for (const line of strip.lines) line.name = `${line.label} ${figure(line.value(row))}`.trim();
      strip.pointed = row === last ? NaN : x[row];
      strip.draw(table, x[last], x[last]);
    }
  };
  grid.addEventListener('pointermove', ({ target, offsetX }) => {
    const strip = strips.find(({ canvas }) => canvas === target);
    if (!strip) return;
    const at = table.countUntil(strip.timeAt(offsetX, x[last], x[last]));
    const nearer = at > 0 && at <= last && 2 * strip.timeAt(offsetX, x[last], x[last]) < x[at - 1] + x[at] ? at - 1 : at;
    row = Math.min(last, Math.max(0, nearer));
    draw();
  });
  grid.addEventListener('pointerleave', () => {
    row = last;
    draw();
  });
  window.addEventListener('resize', draw);
  draw();
}
