// SPDX-License-Identifier: BSD-3-Clause
// What is drawn at one time: between two frames, everything that moves is interpolated.

const kLongestGap_s = 0.1;  // over a longer one, unless all are as long, nothing is known of the motion between

/** Whether a run tells what really is: simulated robots do. */
export const tellsTruth = (frames) => frames.count > 0 && frames.has(0, frames.flags.has_truth);

/** The moment at time t of at least one frame: plain numbers and arrays; `row` is the frame at or before it. */
export function momentAt(frames, t) {
  const row = Math.max(0, frames.countUntil(t) - 1), next = Math.min(row + 1, frames.count - 1);
  const span = frames.time(next) - frames.time(row);
  const usual = (frames.time(frames.count - 1) - frames.time(0)) / Math.max(1, frames.count - 1);
  const share = span > 0 && span < Math.max(kLongestGap_s, 2 * usual) ? Math.min(1, Math.max(0, (t - frames.time(row)) / span)) : 0;
  const mix = (field) => frames.all(row, field).map((a, k) => {
    const b = frames.at(next, field, k);
    return share > 0 && Number.isFinite(b) ? a + share * (b - a) : a;
  });
  return {
    t, row,
    position: mix('position_m'),
    orientation: between(frames.all(row, 'orientation_wxyz'), frames.all(next, 'orientation_wxyz'), share),
    joints: mix('position_rad'),
    forces: mix('foot_force_n'),
    penetration: mix('penetration_m'),
    stance: frames.all(row, 'stance_m'),
    motion: mix('motion'),
    odometry: mix('odometry'),
    requested: frames.all(row, 'requested'),
    given: frames.all(row, 'given'),
    estimate: mix('estimate'),
    truth: mix('truth'),
    mode: frames.at(row, 'mode'),
    faults: frames.at(row, 'faults'),
    warnings: frames.at(row, 'warnings'),
    skipped: frames.at(row, 'skipped'),
    hasTruth: frames.has(row, frames.flags.has_truth),
    hasEstimate: frames.has(row, frames.flags.has_estimate),
  };
}

// Of two unit quaternions that are close to each other: straight between them, on the sphere.
function between(a, b, share) {
  const sign = a.reduce((sum, v, k) => sum + v * b[k], 0) < 0 ? -1 : 1;
  const mixed = a.map((v, k) => (1 - share) * v + share * sign * b[k]);
  const length = Math.hypot(...mixed);
  return length > 0 ? mixed.map((v) => v / length) : [1, 0, 0, 0];
}
