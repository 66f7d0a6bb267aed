#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""tools/bench/view_clients.py [--rounds N] [--seconds S] [--foxglove] [SANDRUNNER]: what clients of --view cost a
run in real time.

Runs the robot in real time, alternately without a client and with four: two that read, one that is stopped (SIGSTOP)
and one that reads a byte a second. With --foxglove they subscribe to all topics as Foxglove does; else they are pages.
Prints a line for each run and the medians. Exit code 1: the clients have a measurable effect. That is one of these: more
ticks skipped or records dropped than without, start lateness (p99, p99.9) or tick (p99) longer by more than 5 %, more
than 2 % of a core per client for the server's thread, 16 MB more memory. Run it on an idle computer. The clients stand
for those on other computers: they run on any processor but the last, which the control thread has."""

import argparse
import json
import os
import pathlib
import re
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time

TOPICS = 10  # channels of Foxglove at most
KINDS = ["reads", "reads", "stopped", "drips"]
COLUMNS = ["skipped", "dropped", "late p99, us", "late p99.9, us", "tick p99, us", "server, % of a core", "RSS, MB"]
SLOWER = 1.05
CORE_PERCENT_A_CLIENT = 2.0
MORE_MB = 16.0


def frame(opcode, content=b""):
    """A short WebSocket frame under a mask that changes nothing."""
    return bytes([0x80 | opcode, 0x80 | len(content), 0, 0, 0, 0]) + content


def be_a_client(kind, port, foxglove):
    """Looks at the run until it is killed or the server ends."""
    here = f"127.0.0.1:{port}"
    server = socket.create_connection(("127.0.0.1", port))
    target, line = ("/", "Sec-WebSocket-Protocol: foxglove.sdk.v1") if foxglove else ("/live", f"Origin: http://{here}")
    server.sendall(f"GET {target} HTTP/1.1\r\nHost: {here}\r\n{line}\r\nUpgrade: websocket\r\n"
                   "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode())
    answer = b""
    while b"\r\n\r\n" not in answer:
        answer += server.recv(4096)
    if not answer.startswith(b"HTTP/1.1 101 "):
        raise SystemExit(f"view_clients.py: the server answers {answer[:40]}, expected 101")
    said = [b'{"say":"hello","key":""}'] if not foxglove else [
        b'{"op":"subscribe","subscriptions":[{"id":%d,"channelId":%d}]}' % (i, i) for i in range(TOPICS)]
    for message in said:
        server.sendall(frame(1, message))
    if kind == "stopped":
        os.kill(os.getpid(), signal.SIGSTOP)
    alive = time.monotonic()
    while server.recv(1 if kind == "drips" else 65536):
        if kind == "drips":
            time.sleep(1)
        if time.monotonic() - alive > 10:  # the server asks who is silent for longer
            alive = time.monotonic()
            server.sendall(frame(10))


def begin_client(kind, port, foxglove):
    pid = os.fork()
    if pid == 0:
        if len(processors := os.sched_getaffinity(0)) > 1:
            os.sched_setaffinity(0, processors - {max(processors)})
        try:
            be_a_client(kind, port, foxglove)
        except OSError:
            pass  # the server has ended
        finally:
            os._exit(0)
    return pid


def server_seconds(pid):
    """Processor time of the server's thread so far."""
    for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
        if (task / "comm").read_text().strip() == "view-server":
            fields = (task / "stat").read_text().rpartition(")")[2].split()
            return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    raise SystemExit("view_clients.py: found no thread 'view-server'")


def measure(program, seconds, kinds, foxglove):
    """One run with these clients; its figures in the order of COLUMNS."""
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.Popen([program, "--view", "--set", "view.port=0", "--clock", "realtime", "--start", "walk",
                                "--duration", str(seconds), "--out", folder],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        clients = []
        try:
            begin = time.monotonic()
            said = ""
            while not (address := re.search(r"127\.0\.0\.1:(\d+)", said)):
                if not (line := run.stderr.readline()):
                    raise SystemExit(f"view_clients.py: {program} ended: {said}")
                said += line
            clients = [begin_client(kind, int(address[1]), foxglove) for kind in kinds]
            while not run.stdout.readline().startswith("wrote "):
                if run.poll() is not None:
                    raise SystemExit(f"view_clients.py: {program} ended with {run.returncode}")
            core = 100 * server_seconds(run.pid) / (time.monotonic() - begin)
            status = pathlib.Path(f"/proc/{run.pid}/status").read_text()
            rss_mb = int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024
            figures = json.loads((pathlib.Path(folder) / "summary.json").read_text())["realtime"]
            return [figures["ticks_skipped"], figures["records_dropped"], figures["late_us"]["p99"],
                    figures["late_us"]["p99_9"], figures["tick_us"]["p99"], core, rss_mb]
        finally:
            for pid in clients:
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
            run.terminate()
            run.communicate()


def line(name, figures):
    return f"{name:<12}" + "".join(f"{value:>{len(column) + 2}.2f}" for column, value in zip(COLUMNS, figures))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/release/bin/sandrunner", metavar="SANDRUNNER")
    parser.add_argument("--rounds", type=int, default=5, metavar="N")
    parser.add_argument("--seconds", type=float, default=30, metavar="S")
    parser.add_argument("--foxglove", action="store_true")
    arguments = parser.parse_args()
    print(" " * 12 + "".join(f"  {column}" for column in COLUMNS))
    runs = {"no client": [], "four": []}
    for _ in range(arguments.rounds):
        for name, kinds in (("no client", []), ("four", KINDS)):
            runs[name].append(measure(arguments.program, arguments.seconds, kinds, arguments.foxglove))
            print(line(name, runs[name][-1]), flush=True)
    without, with_four = ([statistics.median(column) for column in zip(*runs[name])] for name in runs)
    print("medians\n" + line("no client", without) + "\n" + line("four", with_four))
    noticed = [column for i, column in enumerate(COLUMNS)
               if with_four[i] > (without[i] if i < 2 else
                                  SLOWER * without[i] if i < 5 else
                                  without[i] + (len(KINDS) * CORE_PERCENT_A_CLIENT if i == 5 else MORE_MB))]
    print(f"MEASURABLE EFFECT: {'; '.join(noticed)}" if noticed else "the clients have no measurable effect")
    return 1 if noticed else 0


if __name__ == "__main__":
    sys.exit(main())
