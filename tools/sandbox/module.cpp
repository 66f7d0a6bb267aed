// SPDX-License-Identifier: BSD-3-Clause
// What the WebAssembly module exports to page/sandbox.js. Addresses are of the module's memory; one
// page, one thread.
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "rt/core/exact_fma.h"
#include "rt/core/fma.h"
#include "rt/run/offered_ground.h"
#include "tools/sandbox/run.h"

namespace sandrunner::sandbox {
namespace {

std::string bytes;
Setup setup;
std::optional<PageRun> page;
std::optional<ScriptedRun> scripted;
sim::TerrainDescription wanted;

// Same bits, but for the sign of a NaN.
template <typename Real>
bool agree(Real a, Real b, Real c) {
  volatile Real x = a, y = b, z = c;  // the compiler must not know them
  return fma(Real(x), Real(y), Real(z)) == exact_fma(Real(x), Real(y), Real(z));
}

}  // namespace

#define EXPORT(name) extern "C" __attribute__((export_name(#name)))

/// 1: products are fused with sums, in double, in float and in four floats.
EXPORT(fma_is_fused) int fma_is_fused() {
  bool fused = true;
  for (int i = 1; i < 30; ++i) {
    const double d = 1.0 + std::ldexp(1.0, -23 - i % 7) * i;
    fused =
        fused && agree(d, 2.0 - d, -1.0) && agree(d, d, -d * d) && agree(0.1 * i, 0.3, -0.03 * i);
    const float f = 1.0f + std::ldexp(1.0f, -9 - i % 7) * static_cast<float>(i);
    fused = fused && agree(f, 2.0f - f, -1.0f) && agree(f, f, -f * f);
    const v128_t four = fma(wasm_f32x4_splat(f), wasm_f32x4_splat(f), wasm_f32x4_splat(-f * f));
    fused = fused && wasm_f32x4_extract_lane(four, 3) == exact_fma(f, f, -f * f);
  }
  return fused ? 1 : 0;
}

/// Room for the bytes of a Setup.
EXPORT(room) void* room(unsigned size) {
  bytes.resize(size);
  return bytes.data();
}

/// Takes the Setup that is there.
EXPORT(take_setup) void take_setup() {
  setup = from_bytes(bytes);
  bytes = {};
}

/// The run of the command line: where it starts, for how long it walks.
EXPORT(begin_script)
void begin_script(int start_walking, double walk_s, double vx_mps, double vy_mps, double wz_radps) {
  scripted.emplace(setup, VelocityCommand{vx_mps, vy_mps, wz_radps},
                   RunPlan{.walk_s = walk_s, .start_walking = start_walking != 0});
}
/// 1: it goes on.
EXPORT(run_script) int run_script(int ticks) { return scripted->advance(ticks) ? 1 : 0; }
EXPORT(script_s) double script_s() {
  return static_cast<double>(scripted->robot.loop.next_tick()) * kControlPeriod_s;
}
EXPORT(state_hash) std::uint64_t state_hash() { return scripted->robot.state_hash(); }

/// The page's own run begins.
EXPORT(begin_page) void begin_page() {
  page.emplace(setup);
  page->advance(1);  // in its first tick a controller takes no request
}
EXPORT(run_page) void run_page(int ticks) { page->advance(ticks); }
EXPORT(now_s) double now_s() { return page->now_s(); }
// Of ViewRowKind: rows seen in the last ticks.
EXPORT(row_count) unsigned row_count(int kind) {
  const std::array counts = {page->rows.size(), page->footprints.size(), page->tiles.size()};
  return counts[static_cast<unsigned>(kind)];
}
EXPORT(row_size) unsigned row_size(int kind) {
  return std::array{sizeof(RunRow), sizeof(Footprint),
                    sizeof(ViewTile)}[static_cast<unsigned>(kind)];
}
EXPORT(row_data) const void* row_data(int kind) {
  const std::array<const void*, 3> data = {page->rows.data(), page->footprints.data(),
                                           page->tiles.data()};
  return data[static_cast<unsigned>(kind)];
}

EXPORT(drive) void drive(double vx_mps, double vy_mps, double wz_radps) {
  page->drive({vx_mps, vy_mps, wz_radps});
}
/// A row of kRequestTable. Why not, as a C string; null: done.
EXPORT(request) const char* request(unsigned row) { return page->request(row); }
EXPORT(mode) int mode() { return static_cast<int>(page->mode()); }
EXPORT(push) void push(double direction_rad) { page->push(direction_rad); }
EXPORT(set_on_legs) void set_on_legs() { page->set_on_legs(); }

/// The ground to come: a preset, or with -1 that with which the page began.
EXPORT(choose_ground) void choose_ground(int preset) {
  wanted = preset < 0 ? setup.simulator.terrain : setup.presets[static_cast<unsigned>(preset)];
}
/// A setting of it, by its number in kOfferedGround.
EXPORT(set_ground) void set_ground(unsigned setting, double value) {
  wanted.patches.front().ground.*kOfferedGround[setting].second = value;
}
EXPORT(apply_ground) void apply_ground() { page->set_terrain(wanted); }
// Of the ground as it is.
EXPORT(ground_value) double ground_value(unsigned setting) {
  return page->terrain().patches.front().ground.*kOfferedGround[setting].second;
}
EXPORT(ground_kind) int ground_kind() {
  return static_cast<int>(page->terrain().patches.front().ground.kind);
}

}  // namespace sandrunner::sandbox
