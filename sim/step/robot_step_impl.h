// SPDX-License-Identifier: BSD-3-Clause
// Definitions of RobotStepper: the end of robot_step.h, included by it and by nobody else.
#pragma once

namespace sandrunner::sim {

template <typename S>
typename RobotStepper<S>::Frame RobotStepper<S>::contact_frame(
    const Shape<S>& shape, const Surface<S>& surface) const noexcept {
  const Frame level{rotation_.r0, rotation_.r1, rotation_.r2};
  const Mask<S> uneven = shape.uneven > S(0.0);
  if (!any(uneven)) return level;
  const SurfaceAxes<S> axes = surface_axes(surface);
  return {select(uneven, transposed_times(rotation_, axes.t1), level.t1),
          select(uneven, transposed_times(rotation_, axes.t2), level.t2),
          select(uneven, transposed_times(rotation_, axes.n), level.n)};
}

// Turns a motion in the world into one along the plane, in the lanes `along`: that of the place on
// the surface above the deepest point (r_base from the base origin), which stays where it is as the
// foot sinks in.
template <typename S>
void RobotStepper<S>::lay_along(const Shape<S>& shape, const Mask<S>& along,
                                const Vec3<S>& position, const Vec3<S>& r_base,
                                const Vec3<S>& v_base, const Frame& frame,
                                FootMotion<S>& m) const noexcept {
  const Vec3<S> above = position + rotation_ * mul_add(frame.n, m.z, r_base);
  const SurfaceAxes<S> plane = shape.plane_axes();
  m.x = select(along, dot(plane.t1, above), m.x);
  m.y = select(along, dot(plane.t2, above), m.y);
  m.vx = select(along, dot(frame.t1, v_base), m.vx);
  m.vy = select(along, dot(frame.t2, v_base), m.vy);
}

template <typename S>
void RobotStepper<S>::fill_row(const Vec3<S>& e, const Vec3<S>& r_base, int leg,
                               const Columns& columns, std::array<S, 6>& w,
                               std::array<S, 3>& j) noexcept {
  Vec3<S> linear = e, angular = cross(r_base, e);
  if (leg >= 0) {
    for (int i = 0; i < 3; ++i) {
      j[i] = dot(e, columns[i]);
      linear = mul_add(dynamics_.y_linear(leg, i), -j[i], linear);
      angular = mul_add(dynamics_.y_angular(leg, i), -j[i], angular);
    }
  }
  w = dynamics_.half_solve(linear, angular);
}

template <typename S>
void RobotStepper<S>::fill_rows(const Vec3<S>& r_base, int leg, const Columns& columns,
                                const Frame& frame, PointContact<S>& c) noexcept {
  c.leg = leg;
  Vec3<S> velocity = cross_add(free_.angular, r_base, free_.linear);
  if (leg >= 0) {
    for (int i = 0; i < 3; ++i) {
      velocity = mul_add(columns[i], free_.joint[3 * leg + i], velocity);
    }
  }
  const std::array<Vec3<S>, 3> axes{frame.t1, frame.t2, frame.n};
  // A normal impulse that is given only acts: its row needs no velocity and no Delassus block.
  const int solved = any(c.hard) ? 3 : 2;
  for (int r = 0; r < 3; ++r) {
    fill_row(axes[r], r_base, leg, columns, c.w[r], c.j[r]);
    if (r == solved) break;
    c.free[r] = dot(axes[r], velocity);
    if (leg >= 0) {
      const Vec3<S> p = dynamics_.leg_inverse(leg) * Vec3<S>{c.j[r][0], c.j[r][1], c.j[r][2]};
      c.p[r] = {p.x, p.y, p.z};
    }
  }
  const auto block = [&](int a, int b) {
    S v = c.w[a][0] * c.w[b][0];
    for (int i = 1; i < 6; ++i) v = fma(c.w[a][i], c.w[b][i], v);
    if (leg >= 0) {
      for (int i = 0; i < 3; ++i) v = fma(c.p[a][i], c.j[b][i], v);
    }
    return v;
  };
  c.g.xx = block(0, 0);
  c.g.xy = block(0, 1);
  c.g.yy = block(1, 1);
  if (solved < 3) return;
  c.g.xz = block(0, 2);
  c.g.yz = block(1, 2);
  c.g.zz = block(2, 2);
}

// Centre of the foot, or of a patch of it.
template <typename S>
Vec3<S> RobotStepper<S>::foot_in_hip(const RobotModel<S>& model, const FootProfile<S>& foot,
                                     int leg, int patch) const noexcept {
  const LegPose<S>& pose = dynamics_.leg(leg);
  return foot.patches == 1 ? pose.foot : patch_centre(model.legs[leg], pose, patch);
}

template <typename S>
inline void RobotStepper<S>::add_foot(const RobotModel<S>& model, const FootProfile<S>& foot,
                                      const Terrain<S>& terrain, S dt, int l, int patch,
                                      RobotState<S>& x, StepReport<S>& report) noexcept {
  const S zero = S(0.0), one = S(1.0);
  const int number = patch_number(l, patch), slot = slot_of(number);
  const LegPose<S>& pose = dynamics_.leg(l);
  const Vec3<S> centre_hip = foot_in_hip(model, foot, l, patch);
  const Vec3<S> centre_base = hip_to_base(model.legs[l], pose, centre_hip);
  const Vec3<S> centre = x.rigid.position + rotation_ * centre_base;
  FootContact<S>& contact = x.contact(l, patch);
  // A contact keeps the patch of ground on which it began.
  contact.region = select(contact.active == zero, terrain.region_at(centre.x), contact.region);
  const Ground<S>& ground = terrain.pick(contact.region, mixed_ground_);
  const Surface<S> surface = surface_at(terrain.shape, relief_, centre.x, centre.y);
  const Frame frame = contact_frame(terrain.shape, surface);
  // Deepest point: a foot radius from the centre against the normal; depth measured along the
  // normal.
  const Vec3<S> r_base = mul_add(frame.n, -model.foot_radius_m, centre_base);
  const S normal_z = dot(frame.n, rotation_.r2);
  S penetration = model.foot_radius_m - (centre.z - surface.height) * normal_z;
  S heaped = zero;  // of the present surface over the undisturbed one
  if (!prints_.are_none()) {
    heaped = select(ground.footprints > zero,
                    prints_.height_under(number, contact.active, centre.x, centre.y), zero);
    penetration = penetration + heaped;
  }
  const Columns columns = dynamics_.leg_jacobian(
      model, l, centre_hip + unrotate_x(pose.s1, pose.c1, (-model.foot_radius_m) * frame.n));
  Vec3<S> v_base = cross_add(x.rigid.angular_velocity, r_base, velocity_);
  for (int j = 0; j < 3; ++j) v_base = mul_add(columns[j], x.rigid.qd[3 * l + j], v_base);
  const Vec3<S> velocity = rotation_ * v_base;
  const Vec3<S> point = x.rigid.position + rotation_ * r_base;
  FootMotion<S> motion{point.x,    point.y,   penetration, -dot(frame.n, v_base),
                       velocity.x, velocity.y};
  const Mask<S> along = both(terrain.shape.uneven > zero, ground.hard == zero);
  if (any(along)) {
    lay_along(terrain.shape, along, x.rigid.position, r_base, v_base, frame, motion);
  }
  motion.pressed = max(-heaped, zero);
  if (foot.patches == kMaxFootPatches && any(ground.directed > zero)) {
    const std::array<Vec3<S>, kMaxFootPatches>& p = model.legs[l].patch;
    const Vec3<S> up =
        rotate_x(pose.s1, pose.c1, rotate_y(pose.s23, pose.c23, cross(p[0] - p[2], p[0] - p[1])));
    const S inverse = one / max(dot(frame.n, up), S(0.05) * sqrt(dot(up, up)));
    motion.tilt_x = -(dot(frame.t1, up) * inverse);
    motion.tilt_y = -(dot(frame.t2, up) * inverse);
  }
  auto& [force, depth] = patches_[number];
  depth = penetration;
  force = foot_force(ground, foot, motion, rate_, contact);
  if (foot.patches > 1) force = share_of(force, S(1.0 / foot.patches));
  if (!prints_.are_none()) {
    prints_.follow(number, contact.active * ground.footprints, centre.x, centre.y,
                   penetration - heaped, foot.radius * S(std::sqrt(1.0 / foot.patches)),
                   foot.shape == FootShape::kDisc, ground.repose);
  }
  if (patch == 0) {
    report.foot_centre[l] = centre;
    report.penetration[l] = penetration;
    report.heaped[l] = heaped;
    report.foot_velocity[l] = velocity;
    report.raw_force[l] = force.raw;
  } else {
    const Mask<S> deeper = penetration > report.penetration[l];
    report.penetration[l] = select(deeper, penetration, report.penetration[l]);
    report.heaped[l] = select(deeper, heaped, report.heaped[l]);
    report.foot_velocity[l] = select(deeper, velocity, report.foot_velocity[l]);
    report.raw_force[l] = report.raw_force[l] + force.raw;
  }

  PointContact<S>& c = points_[num_points_];
  slots_[num_points_] = slot;
  c.active = penetration >= zero;
  std::array<S, 3>& impulse = x.impulse_of(slot);
  if (!any(c.active)) {
    impulse = {zero, zero, zero};
    return;
  }
  c.hard = ground.hard == one;
  fill_rows(r_base, l, columns, frame, c);
  c.friction = ground.friction;
  c.disc = force.friction_bound * dt;
  c.impulse = {impulse[0], impulse[1], select(c.hard, impulse[2], force.normal * dt)};
  ++num_points_;
}

template <typename S>
void RobotStepper<S>::add_feet(const RobotModel<S>& model, const FootProfile<S>& foot,
                               const Terrain<S>& terrain, S dt, RobotState<S>& x,
                               StepReport<S>& report) noexcept {
  for (int l = 0; l < kNumLegs; ++l) {
    for (int patch = 0; patch < foot.patches; ++patch) {
      add_foot(model, foot, terrain, dt, l, patch, x, report);
    }
  }
  couple_feet(terrain, foot, dt, report);
  if (!prints_.are_none()) prints_.keep_around(x.rigid.position.x, x.rigid.position.y);
}

// Adds what a foot bears of the pressure that all feet on coupled ground make. The points are those
// of the feet.
template <typename S>
void RobotStepper<S>::couple_feet(const Terrain<S>& terrain, const FootProfile<S>& foot, S dt,
                                  StepReport<S>& report) noexcept {
  const S zero = S(0.0);
  if (!any(terrain.coupled > zero)) return;
  S pressure = zero;
  for (int i = 0; i < foot.patches * kNumLegs; ++i) {
    pressure = fma(patches_[i].force.coupling, max(patches_[i].depth, zero), pressure);
  }
  for (int i = 0; i < num_points_; ++i) {
    PointContact<S>& c = points_[i];
    const FootForce<S>& force = patches_[patch_of(slots_[i])].force;
    const Mask<S> shares = both(c.active, force.coupling > zero);
    const S normal = max(fma(force.coupling, pressure, force.uncut), zero);
    S& raw = report.raw_force[slots_[i] % kNumLegs];
    raw = select(shares, foot.patches == 1 ? normal : raw + (normal - force.raw), raw);
    c.disc = select(shares, c.friction * normal * dt, c.disc);
    c.impulse[2] = select(shares, normal * dt, c.impulse[2]);
  }
}

template <typename S>
void RobotStepper<S>::add_hard_point(const RobotModel<S>& model, const Terrain<S>& terrain,
                                     const HardPoint& point, const Mask<S>& near, RobotState<S>& x,
                                     S& touched) noexcept {
  const auto [r_base, r_hip, radius, leg, joints, only_hard, slot] = point;
  const S zero = S(0.0), one = S(1.0);
  const Vec3<S> place = x.rigid.position + rotation_ * r_base;
  const auto forget = [&x, at = point.slot, zero] { x.impulse[at] = {zero, zero, zero}; };
  // Lanes outside this mask stay outside, whatever rounding says of them further down: one robot
  // alone stops here.
  const Shape<S>& shape = terrain.shape;
  const Mask<S> close =
      both(near, fma(-radius, shape.stretch, shape.over_plane(place)) < shape.crest);
  if (!any(close)) return forget();
  const Ground<S>& ground = terrain.pick(terrain.region_at(place.x), mixed_ground_);
  const Surface<S> surface = surface_at(shape, relief_, place.x, place.y);
  const Frame frame = contact_frame(shape, surface);
  const S penetration = radius - (place.z - surface.height) * dot(frame.n, rotation_.r2);
  Mask<S> active = both(close, penetration >= zero);
  if (only_hard) active = both(active, ground.hard == one);
  touched = select(active, one, touched);
  if (!any(active)) return forget();
  PointContact<S>& c = points_[num_points_];
  slots_[num_points_] = slot;
  ++num_points_;
  const Vec3<S> arm = mul_add(frame.n, -radius, r_base);
  Columns columns;
  if (leg >= 0) {
    const LegPose<S>& pose = dynamics_.leg(leg);
    columns = dynamics_.leg_jacobian(model, leg,
                                     r_hip + unrotate_x(pose.s1, pose.c1, (-radius) * frame.n));
    if (joints < 3) columns[2] = {zero, zero, zero};
  }
  c.active = active;
  c.hard = active;
  fill_rows(arm, leg, columns, frame, c);
  c.friction = ground.friction;
  c.disc = zero;
  c.impulse = x.impulse[slot];
}

template <typename S>
void RobotStepper<S>::add_body_points(const RobotModel<S>& model, const Terrain<S>& terrain,
                                      RobotState<S>& x, StepReport<S>& report) noexcept {
  const S zero = S(0.0);
  const Shape<S>& shape = terrain.shape;
  report.base_contact = report.thigh_contact = zero;
  S shank_contact = zero;  // not reported
  for (int l = 0; l < kNumLegs; ++l) {
    const LegPose<S>& pose = dynamics_.leg(l);
    const Vec3<S> knee_base = hip_to_base(model.legs[l], pose, pose.knee);
    report.knee[l] = x.rigid.position + rotation_ * knee_base;
    const HardPoint knee{.r_base = knee_base,
                         .r_hip = pose.knee,
                         .radius = model.knee_radius_m,
                         .leg = l,
                         .joints = 2,
                         .slot = kNumLegs + l};
    add_hard_point(model, terrain, knee, every_lane<S>(), x, report.thigh_contact);
    // On a plane knee and foot cover the shank; only waves of hard ground can touch it.
    const Mask<S> waves = shape.crest > zero;
    if (any(waves)) {
      const Vec3<S> middle = S(0.5) * (pose.knee + pose.foot);
      const HardPoint shank{.r_base = hip_to_base(model.legs[l], pose, middle),
                            .r_hip = middle,
                            .radius = model.shank_radius_m,
                            .leg = l,
                            .joints = 3,
                            .only_hard = true,
                            .slot = 2 * kNumLegs + l};
      add_hard_point(model, terrain, shank, waves, x, shank_contact);
    }
  }
  // Heights over the plane; `up`: their gradient.
  const Vec3<S>& half = model.base_box_half_m;
  const Vec3<S> up =
      mul_add(rotation_.r0, -shape.slope_x, mul_add(rotation_.r1, -shape.slope_y, rotation_.r2));
  const S reach = fma(abs(up.x), half.x, fma(abs(up.y), half.y, abs(up.z) * half.z));
  const S lowest = (shape.over_plane(x.rigid.position) + dot(up, model.base_box_centre_m)) - reach;
  const Mask<S> low = lowest < shape.crest;
  if (!any(low)) {
    for (int i = 0; i < kNumBaseCorners; ++i) x.impulse[3 * kNumLegs + i] = {zero, zero, zero};
    return;
  }
  for (int i = 0; i < kNumBaseCorners; ++i) {
    const Vec3<S> corner =
        model.base_box_centre_m +
        Vec3<S>{(i & 1) ? half.x : -half.x, (i & 2) ? half.y : -half.y, (i & 4) ? half.z : -half.z};
    add_hard_point(model, terrain, {.r_base = corner, .radius = zero, .slot = 3 * kNumLegs + i},
                   low, x, report.base_contact);
  }
}

template <typename S>
void RobotStepper<S>::add_stops(const RobotModel<S>& model, S dt, const RobotState<S>& x) noexcept {
  const S zero = S(0.0);
  for (int joint = 0; joint < kNumJoints; ++joint) {
    const int leg = joint / 3, j = joint % 3;
    const S q = x.rigid.q[joint];
    const S above = q - model.lower_rad[joint], below = model.upper_rad[joint] - q;
    const Mask<S> at_lower = above < below;
    const S gap = select(at_lower, above, below);
    const S sign = select(at_lower, S(1.0), S(-1.0));
    const S free = sign * free_.joint[joint];
    const Mask<S> active = fma(dt, free, gap) < zero;
    if (!any(active)) continue;
    stop_joints_[num_stops_] = joint;
    StopRow<S>& c = stops_[num_stops_++];
    c.leg = leg;
    c.active = active;
    c.j = {zero, zero, zero};
    c.j[j] = sign;
    c.w = dynamics_.half_solve((-sign) * dynamics_.y_linear(leg, j),
                               (-sign) * dynamics_.y_angular(leg, j));
    const Vec3<S> p = dynamics_.leg_inverse(leg) * Vec3<S>{c.j[0], c.j[1], c.j[2]};
    c.p = {p.x, p.y, p.z};
    S g = c.p[j] * sign;
    for (int i = 0; i < 6; ++i) g = fma(c.w[i], c.w[i], g);
    c.g = g;
    // May close the gap within the step; beyond the stop it only may not go further.
    c.free = fma(max(gap, zero), rate_, free);
    c.impulse = max(sign * x.stop_impulse[joint], zero);
  }
}

/// What is left of the drives' torques behind the friction of their joints.
template <typename S>
std::array<S, kNumJoints> behind_friction(const RobotModel<S>& model,
                                          const std::array<S, kNumJoints>& qd,
                                          const std::array<S, kNumJoints>& torque_nm) noexcept {
  const S zero = S(0.0), one = S(1.0);
  std::array<S, kNumJoints> left = torque_nm;
  for (int j = 0; j < kNumJoints; ++j) {
    const S friction = model.friction_nm[j];
    const Mask<S> rubs = friction > zero;
    if (!any(rubs)) continue;
    const S share = min(max(S(1.0 / kFrictionSpeed_radps) * qd[j], -one), one);
    left[j] = select(rubs, fma(-friction, share, torque_nm[j]), torque_nm[j]);
  }
  return left;
}

template <typename S>
void RobotStepper<S>::step(const RobotModel<S>& model, const FootProfile<S>& foot,
                           const Terrain<S>& terrain, const StepSettings& settings,
                           const std::array<S, kNumJoints>& torque_nm, RobotState<S>& x,
                           StepReport<S>& report, const Relief<S>& relief,
                           const Prints<S>& prints) noexcept {
  const S dt = S(settings.dt_s), zero = S(0.0);
  rate_ = S(1.0) / dt;
  relief_ = relief;
  prints_ = prints;
  rotation_ = rotation_matrix(x.rigid.orientation);
  dynamics_.update(model, x.rigid);
  const Motion<S> acceleration =
      dynamics_.free_acceleration(behind_friction(model, x.rigid.qd, torque_nm));
  velocity_ = transposed_times(rotation_, x.rigid.velocity);
  free_.linear = mul_add(acceleration.linear, dt, velocity_);
  free_.angular = mul_add(acceleration.angular, dt, x.rigid.angular_velocity);
  for (int j = 0; j < kNumJoints; ++j) {
    free_.joint[j] = fma(dt, acceleration.joint[j], x.rigid.qd[j]);
  }

  num_points_ = num_stops_ = 0;
  add_feet(model, foot, terrain, dt, x, report);
  add_body_points(model, terrain, x, report);
  add_stops(model, dt, x);

  ImpulseSum<S> sum;
  report.sweeps = solve_contacts<S, kMaxPoints, kNumJoints>(
      points_, num_points_, stops_, num_stops_, S(settings.tolerance_ns), settings.max_sweeps, sum);
  for (auto& force : report.foot_force) force = {zero, zero, zero};
  for (int i = 0; i < num_points_; ++i) {
    const int slot = slots_[i];
    x.impulse_of(slot) = points_[i].impulse;
    if (slot >= kNumLegs && slot < kNumPoints) continue;
    for (int r = 0; r < 3; ++r) {
      const S force = points_[i].impulse[r] * rate_;
      S& all = report.foot_force[slot % kNumLegs][r];
      all = slot < kNumLegs ? force : all + force;
    }
  }
  x.stop_impulse.fill(zero);
  for (int i = 0; i < num_stops_; ++i) {
    const int joint = stop_joints_[i];
    // Not the product alone: it is -0 for a lane that has left its upper stop, where one robot
    // alone has +0.
    x.stop_impulse[joint] =
        select(stops_[i].impulse > zero, stops_[i].j[joint % 3] * stops_[i].impulse, zero);
  }

  // Stroke resistance acts outside the contact problem, on the flank of the foot: a radius outwards
  // and up from the deepest point, which is level with the centre.
  for (int i = 0; i < foot.patches * kNumLegs; ++i) {
    const FootForce<S>& f = patches_[i].force;
    if (!any(f.stroke > zero)) continue;
    const int l = i % kNumLegs;
    const LegPose<S>& pose = dynamics_.leg(l);
    const Vec3<S> centre_hip = foot_in_hip(model, foot, l, i / kNumLegs);
    const Vec3<S> centre_base = hip_to_base(model.legs[l], pose, centre_hip);
    const Vec3<S> centre = x.rigid.position + rotation_ * centre_base;
    const Frame frame =
        contact_frame(terrain.shape, surface_at(terrain.shape, relief_, centre.x, centre.y));
    const Vec3<S> outward =
        mul_add(frame.t1, f.direction_x, mul_add(frame.t2, f.direction_y, zero * frame.n));
    const Vec3<S> arm = mul_add(outward, model.foot_radius_m, centre_base);
    const Vec3<S> arm_hip =
        centre_hip + unrotate_x(pose.s1, pose.c1, model.foot_radius_m * outward);
    std::array<S, 6> w;
    std::array<S, 3> j;
    fill_row(outward, arm, l, dynamics_.leg_jacobian(model, l, arm_hip), w, j);
    add_impulse(w, j, l, -(f.stroke * dt), sum);
    report.foot_force[l][0] = fma(-f.stroke, f.direction_x, report.foot_force[l][0]);
    report.foot_force[l][1] = fma(-f.stroke, f.direction_y, report.foot_force[l][1]);
  }

  // Velocities, then positions with the new velocities.
  Vec3<S> linear, angular;
  dynamics_.back_solve(sum.y, linear, angular);
  report.base_acceleration = mul_add(linear, rate_, acceleration.linear);
  x.rigid.velocity = x.rigid.velocity + rotation_ * mul_add(acceleration.linear, dt, linear);
  x.rigid.angular_velocity = free_.angular + angular;
  for (int l = 0; l < kNumLegs; ++l) {
    const std::array<S, 3>& u = sum.joint[l];
    const Vec3<S> z = dynamics_.leg_inverse(l) * Vec3<S>{u[0], u[1], u[2]};
    const std::array<S, 3> zs{z.x, z.y, z.z};
    for (int j = 0; j < 3; ++j) {
      x.rigid.qd[3 * l + j] =
          free_.joint[3 * l + j] + (zs[j] - (dot(dynamics_.y_linear(l, j), linear) +
                                             dot(dynamics_.y_angular(l, j), angular)));
      x.rigid.q[3 * l + j] = fma(dt, x.rigid.qd[3 * l + j], x.rigid.q[3 * l + j]);
    }
  }
  x.rigid.position = mul_add(x.rigid.velocity, dt, x.rigid.position);
  x.rigid.orientation = integrate(x.rigid.orientation, dt * x.rigid.angular_velocity);
}

}  // namespace sandrunner::sim
