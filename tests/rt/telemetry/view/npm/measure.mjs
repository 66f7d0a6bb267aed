// SPDX-License-Identifier: BSD-3-Clause
// node measure.mjs BROWSER SANDRUNNER FOLDER: times between a robot in real time and a page in Chromium, in milliseconds.
// What the robot did and when is read from the recording's clock and run.csv. For a computer that does little else.
import fs from "node:fs";
import { spawn } from "node:child_process";
import { endServers, launch as launchBrowser, serve } from "./served_page.mjs";

const [browserPath, sandrunner, folder] = process.argv.slice(2);
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const now = () => performance.timeOrigin + performance.now();
const ms = (value) => `${value.toFixed(0)} ms`;
const quantile = (values, share) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))];
const browsers = new Set();

const start = (...words) => serve(sandrunner, ...words);

async function launch() {
  const browser = await launchBrowser(browserPath);
  browsers.add(browser);
  return browser;
}

/** A page that notes when each frame came, by the wall clock: window.came, of [milliseconds, t_s]. */
async function open(browser, url) {
  const page = await browser.newPage();
  await page.setViewport({ width: 320, height: 240 });
  await page.evaluateOnNewDocument(() => {
    window.came = [];
    const Socket = window.WebSocket;
    window.WebSocket = class extends Socket {
      constructor(...words) {
        super(...words);
        this.addEventListener("message", ({ data }) => {
          if (typeof data === "string") return;
          const at = performance.timeOrigin + performance.now(), [kind, count] = new Uint32Array(data, 0, 2);
          const size = (data.byteLength - 8) / count, rows = new DataView(data, 8);
          if (kind === 0) for (let row = 0; row < count; ++row) window.came.push([at, rows.getFloat64(row * size, true)]);
        });
      }
    };
  });
  await page.goto(url);
  await page.waitForFunction("window.sandrunner?.ready_ms", { timeout: 60000 });
  return page;
}

const until = (page, what, timeout = 60000) => page.waitForFunction(what, { timeout, polling: 10 });
const lost = "document.getElementById('lost').textContent";
const rssKb = (pid) => Number(/VmRSS:\s+(\d+)/.exec(fs.readFileSync(`/proc/${pid}/status`, "utf8"))[1]);
const endOf = (child) => new Promise((resolve) => {
  child.on("exit", resolve);
  child.kill("SIGINT");
});

/** When tick 0 was, by the wall clock: the summary of a recording says when its first message was. */
function beginOf(recording) {
  const bytes = fs.readFileSync(recording), kStatistics = 0x0b;
  let at = Number(bytes.readBigUInt64LE(bytes.length - 28));  // footer: summary's start, its offsets' start, CRC; magic
  while (bytes[at] !== kStatistics) at += 9 + Number(bytes.readBigUInt64LE(at + 1));
  return Number(bytes.readBigUInt64LE(at + 9 + 8 + 2 + 4 * 4) / 1000n) / 1000;
}

async function latencyAndGaps(seconds) {
  const dir = `${folder}/latency`;
  const { url, child } = await start("--set", "view.port=0", "--clock", "realtime", "--start", "walk", "--duration", `${seconds + 60}`, "--record", dir);
  const browser = await launch(), page = await open(browser, url);
  await page.evaluate("window.came = []");
  await sleep(1000 * seconds);
  const came = (await page.evaluate("window.came")).slice(1);
  await browser.close();
  await endOf(child);
  const begin = beginOf(`${dir}/run.mcap`);
  const late = came.map(([at, t]) => at - begin - 1000 * t);
  let gap = 0;
  for (let i = 1; i < came.length; ++i) gap = Math.max(gap, came[i][1] - came[i - 1][1]);
  console.log(`tick to page: p50 ${ms(quantile(late, 0.5))}, p95 ${ms(quantile(late, 0.95))}, most ${ms(quantile(late, 1))}; of ${came.length} frames in ${seconds} s the farthest two are ${ms(1000 * gap)} apart`);
}

async function breaks() {
  const first = await start("--set", "view.port=0", "--duration", "600");
  const port = new URL(first.url).port, browser = await launch(), page = await open(browser, first.url);
  await until(page, "sandrunner.frames > 100");
  await page.evaluate("window.sameDocument = true");
  const killed = now();
  first.child.kill("SIGKILL");
  await until(page, `${lost} !== ''`);
  console.log(`server killed: LOST after ${ms(now() - killed)}, ${await page.evaluate("sandrunner.frames")} frames stay`);
  const again = now(), { url, child } = await start("--set", `view.port=${port}`, "--duration", "600");
  const up = now();
  await until(page, `${lost} === '' && sandrunner.run.frames.time(0) < 0.1 && sandrunner.frames > 2`);
  console.log(`server started again: live after ${ms(now() - again)} (its port was open after ${ms(up - again)}), reloaded: ${!(await page.evaluate("window.sameDocument"))}`);

  await page.close();

  // With a full past of 60 s, which comes soonest at four times the speed, the server's memory does not grow any more.
  const second = await open(browser, url), pace = (rate) => second.evaluate((wanted) => window.sandrunner.run.live.say({ say: "pace", rate: wanted }), rate);
  await pace(4);
  await until(second, "sandrunner.player.end > 65", 120000);
  await pace(1);
  await until(second, `${lost} === '' && sandrunner.run.live.state.rate === 1`);
  const calm = rssKb(child.pid);
  await sleep(30000);
  const before = rssKb(child.pid), group = -browser.process().pid;
  const end = await second.evaluate("sandrunner.player.end"), stopped = now();
  process.kill(group, "SIGSTOP");
  await sleep(30000);
  const more = rssKb(child.pid) - before, on = now(), newest = end + (on - stopped) / 1000 - 0.1;
  process.kill(group, "SIGCONT");
  await until(second, `sandrunner.player.t > ${newest}`);
  const shown = now(), came = await second.evaluate(`window.came.find(([, t]) => t > ${newest})`);
  console.log(`browser stopped for 30 s: newest frame came ${ms(came[0] - on)} and was shown ${ms(shown - on)} after it went on; the server had ${more} kB more, after the 30 s before ${before - calm} kB`);
  await browser.close();
  await endOf(child);
}

/** Drives, ends the command by `stop`, and says when the controller had which velocity. */
async function drives(name, stop) {
  const dir = `${folder}/drive`;
  const { url, child } = await start("--set", "view.port=0", "--clock", "realtime", "--command", "live", "--record", dir, "--out", dir);
  const browser = await launch(), page = await open(browser, url);
  const ask = (request) => page.evaluate((wanted) => [...document.querySelectorAll("#requests button")].find((b) => b.textContent === wanted).click(), request);
  const mode = (wanted) => until(page, `document.getElementById('mode').textContent === '${wanted}'`);
  for (const [request, wanted] of [["arm", "damping"], ["stand", "stand"], ["walk", "walk"]]) {
    await ask(request);
    await mode(wanted);
  }
  const pressed = now();
  await page.keyboard.down("w");
  await sleep(1500);
  const stopped = now();
  await stop({ page, browser, child });
  const done = now();
  await sleep(4000);
  await endOf(child);
  const begin = beginOf(`${dir}/run.mcap`);
  const [head, ...lines] = fs.readFileSync(`${dir}/run.csv`, "utf8").trim().split("\n").map((line) => line.split(","));
  const column = (field) => head.indexOf(field), rows = lines.map((line) => ({ at: begin + 1000 * Number(line[column("t_s")]), vx: Number(line[column("command_vx_mps")]), speed: Number(line[column("vx_mps")]) }));
  // The controller limits how fast a command changes: what counts is when it begins to.
  const most = Math.max(...rows.map(({ vx }) => vx)), full = rows.find(({ vx }) => vx === most);
  const from = rows.find(({ vx }) => vx > 0), to = rows.find(({ at, vx }) => at > full.at && vx < most);
  const slow = Math.abs(rows.at(-1).speed);
  console.log(`${name}: key to controller ${ms(from.at - pressed)}; zero at the controller ${ms(to.at - stopped)} after it began, ${ms(to.at - done)} after it was done; at the end ${slow.toFixed(2)} m/s`);
  await browser.close().catch(() => {});
}

/** Stops the server's thread alone, as a debugger does. */
async function stopThread(pid) {
  const task = fs.readdirSync(`/proc/${pid}/task`).find((t) => fs.readFileSync(`/proc/${pid}/task/${t}/comm`, "utf8").trim() === "view-server");
  const tracer = spawn("python3", ["-c", `
import ctypes, time
libc = ctypes.CDLL(None)
SEIZE, INTERRUPT = 0x4206, 0x4207
assert libc.ptrace(SEIZE, ${task}, None, None) == 0 and libc.ptrace(INTERRUPT, ${task}, None, None) == 0
print("stopped", flush=True)
time.sleep(3)`], { stdio: ["ignore", "pipe", "inherit"] });
  await new Promise((resolve) => { tracer.stdout.once("data", resolve); });
}

try {
  await latencyAndGaps(60);
  await breaks();
  await drives("key released", ({ page }) => page.keyboard.up("w"));
  await drives("tab closed", ({ page }) => page.close());
  await drives("Chromium killed", ({ browser }) => process.kill(-browser.process().pid, "SIGKILL"));
  await drives("server's thread stopped", ({ child }) => stopThread(child.pid));
} finally {
  for (const browser of browsers) browser.process()?.kill("SIGKILL");
  endServers();
}
