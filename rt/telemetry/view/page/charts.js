// SPDX-License-Identifier: BSD-3-Clause
// The plots beside the scene, from the fields of the frames.
import { tellsTruth } from './moment.js';
import { Strip } from './plots.js';
import { kTheme } from './theme.js';

// Legs of a pair often move alike: left ones are wide, right ones narrow and on top.
const { grey: kCommanded, blue: kTrue, orange: kEstimated, legs: kLegColors } = kTheme;
const kDeadline_us = 250, kJointsPerLeg = 3;
export const kSpan_s = 6;

export function makeCharts({ hello, frames }, robot, parent) {
  // Without truth, what it alone tells is left out.
  const hasTruth = tellsTruth(frames);
  const truth = (value) => (hasTruth ? [{ name: 'true', color: kTrue, value }] : []);
  const at = (field, k = 0, scale = 1) => (i) => scale * frames.at(i, field, k);
  const legs = (value) => hello.legs.map((name, l) => ({ name, color: kLegColors[l], wide: l % 2 === 0, value: value(l) }));
  const commanded = (k) => ({ name: 'commanded', color: kCommanded, dash: [4, 3], value: at('requested', k) });
  const strip = (...args) => new Strip(parent, ...args);
  const joints = (what, field, unit, limit) => ['first joint', 'second joint', 'knee'].map((joint, k) => {
    const name = jointKind(hello, k) ?? joint, most = robot.limits[k]?.[limit];
    return strip(`${what} ${name}`, unit, legs((l) => at(field, kJointsPerLeg * l + k)),
      { limits: Number.isFinite(most) && most > 0 ? [-most, most] : [], least: 1, zero: true });
  });
  const charts = [
    strip('Forward speed', 'm/s', [commanded(0), ...truth(at('motion', 0)),
      { name: 'estimated', color: kEstimated, value: at('estimate', 1) }], { least: 0.5, zero: true }),
    strip('Sideways speed', 'm/s', [commanded(1), ...truth(at('motion', 1)),
      { name: 'estimated', color: kEstimated, value: at('estimate', 2) }], { least: 0.5, zero: true }),
    strip('Yaw rate', 'rad/s', [commanded(2),
      { name: hasTruth ? 'true' : 'measured', color: kTrue, value: at('motion', 2) }], { least: 0.5, zero: true }),
    strip('Body height', 'm', [...truth(at('truth', 0)),
      { name: 'estimated', color: kEstimated, value: at('estimate', 0) }], { least: 0.1 }),
    ...(hasTruth ? [strip('Sinkage', 'mm', legs((l) => (i) => Math.max(0, 1000 * frames.at(i, 'penetration_m', l))),
      { least: 10, zero: true })] : []),
    ...joints('Torque', 'peak_torque_nm', 'N m, peaks', 'torque'),
    ...joints('Speed', 'velocity_radps', 'rad/s', 'speed'),
    strip('Mechanical power', 'W', [{ name: '', color: kTrue, value: at('power_w') }], { least: 20, zero: true }),
    ...(hasTruth ? [strip('Cost of transport', 'over 1 s',
      [{ name: '', color: kTrue, value: at('cost_of_transport') }], { least: 1, zero: true })] : []),
  ];
  if (frames.columns.tick_us[0].some((us) => us > 0)) {
    charts.push(strip('Worst times of the control loop', 'µs', [
      { name: 'late', color: kTheme.green, value: at('late_us') }, { name: 'control step', color: kTrue, value: at('control_us') },
      { name: 'tick', color: kEstimated, value: at('tick_us') }], { limits: [kDeadline_us], least: 50, zero: true }));
  }
  return charts;
}

/** "HAA" where the k-th joint of every leg is called LEG_HAA. */
function jointKind(hello, k) {
  const kinds = new Set(hello.legs.map((leg, l) => hello.joints[kJointsPerLeg * l + k].replace(leg, '').replace(/^_/, '')));
  return kinds.size === 1 ? [...kinds][0] : null;
}
