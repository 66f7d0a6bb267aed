// SPDX-License-Identifier: BSD-3-Clause
// The page: takes a run from its source and draws it over time.
import './three_notice.js';
import { kSpan_s, makeCharts } from './charts.js';
import { showCurve } from './curve.js';
import { Drive } from './drive.js';
import { hasRun, readCurve, readRun } from './file.js';
import { SceneControls } from './scene_controls.js';
import { Live } from './live.js';
import { LivePlayer } from './live_player.js';
import { momentAt, tellsTruth } from './moment.js';
import { kColors } from './overlays.js';
import { Player } from './player.js';
import { Robot } from './robot.js';
import { makeRobotTime } from './robot_time.js';
import { hasSandbox, openSandbox } from './sandbox.js';
import { Scene } from './scene.js';
import { State } from './state.js';
import { Surface } from './surface.js';
import { Timeline } from './timeline.js';

const element = (id) => document.getElementById(id);
const kLongestStep_s = 0.1;  // after a pause of the browser the run goes on where it was

function makeView(run, robot, surface) {
  const light = location.hash === '#light';
  try {
    return new Scene(element('scene'), run, robot, surface, light ? 3 : 0);
  } catch (error) {
    element('note').textContent = `${run.hello.note} This browser has no WebGL: plots and figures only.`.trim();
    element('camera').hidden = element('picture').hidden = true;
    return { draw() {} };
  }
}

function makeLegend(view) {
  if (!view.overlays) return;
  const belief = ['belief', 'estimated by the network', [kColors.belief]];
  const entries = view.overlays.hasTruth
    ? [['force', 'contact forces', [kColors.force]], belief, ['path', 'path: true, dead-reckoned', [kColors.truth, kColors.belief]]]
    : [belief, ['path', 'path, dead-reckoned', [kColors.belief]]];
  for (const [kind, text, colors] of entries) {
    const label = document.createElement('label'), box = document.createElement('input');
    box.type = 'checkbox';
    box.checked = true;
    box.onchange = () => { view.overlays.kinds[kind].visible = box.checked; };
    label.append(box, ...colors.map((color) => {
      const bar = document.createElement('i');
      bar.style.background = color;
      return bar;
    }), text);
    element('legend').append(label);
  }
}

function savePicture(view, t) {
  view.picture((blob) => {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = `sandrunner-${t.toFixed(2)}s.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  });
}

// What only a page with a server has.
function makeLive({ live, frames, hello }, player, view, changed) {
  const showTime = makeRobotTime(live), drive = new Drive(live, hello), lost = element('lost');
  const controls = new SceneControls(live, frames, view, (granular) => {
    hello.granular = granular;
    view.groundIsSoft?.(hello.granular);
    changed();
  });
  element('now').hidden = live.recorded;
  element('now').onclick = () => player.follow();
  live.onRun = () => {
    view.beginAnew?.();
    player.follow();
    changed();
  };
  live.onState = () => {
    showTime();
    drive.show();
    controls.show();
  };
  live.onAnswer = (message) => drive.answer(message);
  showTime();
  controls.show();
  return () => {
    if (frames.count > 0) drive.showMode(frames.at(frames.count - 1, 'mode'));
    const text = live.lost ? 'LOST: nothing is heard of the robot' : '';
    if (lost.textContent !== text) lost.textContent = text;
  };
}

function show(run) {
  const { hello, frames } = run;
  if (frames.count === 0) {
    element('note').textContent = hello.note;
    window.sandrunner = { ready_ms: performance.now(), frames: 0 };
    return;
  }
  const robot = new Robot(hello.urdf, hello.base, hello.joints);
  const state = new State(hello, tellsTruth(frames));
  robot.pose(momentAt(frames, frames.time(0)));
  const surface = new Surface(run), view = makeView(run, robot, surface);
  const player = run.live ? new LivePlayer(run) : new Player(frames);
  const timeline = new Timeline(element('time'), run, player);
  const charts = makeCharts(run, robot, element('plots'));
  makeLegend(view);
  element('play').onclick = () => player.toggle();
  element('rate').onchange = () => { player.rate = Number(element('rate').value); };
  element('camera').onclick = () => view.resetCamera();
  element('picture').onclick = () => savePicture(view, player.t);
  // A button that was clicked does not take the space key; a field to write in keeps its keys.
  window.addEventListener('click', (event) => { if (event.detail > 0 && event.target.type !== 'number') document.activeElement?.blur(); });
  window.addEventListener('keydown', (event) => { if (event.key === 'c' && !event.ctrlKey) view.resetCamera?.(); });

  // Nothing is drawn again while nothing changes.
  let drawn = 0, before = performance.now(), shown_s = NaN, changed = true;
  for (const event of ['click', 'input', 'keydown', 'resize', 'scroll', 'pointermove', 'wheel', 'touchmove']) {
    window.addEventListener(event, () => { changed = true; }, { capture: true, passive: true });
  }
  const inSight = (canvas) => {
    const plots = element('plots'), top = canvas.offsetTop - plots.offsetTop - plots.scrollTop;
    return top < plots.clientHeight && top + canvas.clientHeight > 0;
  };
  const showLive = run.live ? makeLive(run, player, view, () => { changed = true; }) : () => {};
  const draw = (took_ms = 0) => {
    changed = false;
    view.groundCame?.(surface.takeNew());
    shown_s = player.t;
    const moment = momentAt(frames, player.t);
    robot.pose(moment);
    view.draw(moment, took_ms);
    state.show(moment);
    timeline.draw();
    // Plots are read, not watched: every third picture is enough while the run plays.
    if (!player.playing || drawn % 3 === 0) {
      const whole = element('span').value === 'run', until = whole ? player.end : player.t;
      for (const chart of charts.filter(({ canvas }) => inSight(canvas))) {
        chart.pointed = whole ? player.t : NaN;
        chart.draw(frames, until, whole ? Math.max(player.end - player.begin, 0.1) : kSpan_s);
      }
    }
    ++drawn;
  };
  const step = (now) => {
    requestAnimationFrame(step);
    const passed_ms = Math.max(0, now - before);
    before = now;
    player.advance(Math.min(kLongestStep_s, passed_ms / 1000));
    showLive();
    const label = player.playing ? 'pause view' : 'play';
    if (element('play').textContent !== label) element('play').textContent = label;
    if (frames.count === 0) return;  // another run is about to begin
    if (changed || player.t !== shown_s) draw(player.playing && passed_ms < 1000 ? passed_ms : 0);
  };
  draw();
  requestAnimationFrame(step);

  // For tests and for who is curious in the console.
  window.sandrunner = {
    ready_ms: performance.now(),
    kind: view instanceof Scene ? '3d' : 'plots',
    get frames() { return frames.count; },
    hello, run, player, view, robot,
    get drawn() { return drawn; },
    get quality() { return view.quality; },
    seek(t) {
      player.seek(t);
      draw();
    },
    /** Where the feet are at time t, by the page's own kinematics; draws nothing. */
    feetAt(t) {
      robot.pose(momentAt(frames, t));
      return this.feet();
    },
    feet: () => hello.feet.map((foot) => robot.where(foot).toArray()),
  };
}

async function showFile() {
  const curve = await readCurve();
  if (curve) showCurve(curve);
  show(await readRun());
  if (curve) {
    window.sandrunner.curve = curve;
    [document.title] = curve.title.split(',');
  }
}

async function showSandbox() {
  const open = await openSandbox();
  if (open) new Live(show, open);
}

if (hasRun()) showFile(); else if (hasSandbox()) showSandbox(); else new Live(show);
