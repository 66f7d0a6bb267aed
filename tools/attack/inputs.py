# SPDX-License-Identifier: BSD-3-Clause
"""Random inputs of the programs. Each is drawn from its own seed and writes its files into a folder of its own."""

import dataclasses
import signal

SHORT = ['--start', 'walk', '--duration', '0.02']
DOMAIN = '@DOMAIN@'  # in a word of a command: a DDS domain that nobody else uses
# Of a live robot, tighter than those of the one that ships: torque, N m; forward, backward,
# sideways, m/s; yaw, rad/s.
BOUNDS = {'gate.torque_limit_nm': 50, 'shaping.forward_mps': 1, 'shaping.backward_mps': 0.5,
          'shaping.lateral_mps': 0.3, 'shaping.yaw_radps': 0.7}
# Each of them ends a program or stops it, by default.
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGUSR2,
           signal.SIGALRM, signal.SIGXCPU, signal.SIGXFSZ, signal.SIGTSTP, signal.SIGPIPE, signal.SIGKILL]
VALUES = ['', '0', '-0.0', '-1', '1', '2', '1e-320', '1e308', '-1e308', '1e999', 'nan', '-nan', 'inf', '-inf', 'true',
          'false', '"x"', "'", '"', '[]', '[1,2', '{}', '{a=1}', '9223372036854775807', '9223372036854775808', '0x7f',
          '1_000', '1979-05-27', '"' + 'x' * 5000 + '"', '\\', '\n', '\x01', 'ä', '=', '1=2', '[' * 3000, '1 # 2']


@dataclasses.dataclass
class Input:
    """One run of one program."""
    kind: str
    command: list  # program, arguments
    broken: bool = False  # surely: it must be refused
    shell: str = ''  # what bash does before, in the same process
    environment: dict = dataclasses.field(default_factory=dict)
    signals: list = dataclasses.field(default_factory=list)  # (seconds after the start, signal)
    other_user: bool = False
    beside: list = dataclasses.field(default_factory=list)  # commands that run until it has ended


def number(rng):
    """A value of a setting or option: at and beyond bounds, or of a wrong type."""
    draw = rng.random()
    if draw < 0.5:
        return rng.choice(VALUES)
    if draw < 0.75:
        return repr(rng.uniform(-1, 1) * 10.0 ** rng.randint(-12, 12))
    return str(rng.randint(-1000, 1000) * 10 ** rng.randint(0, 15))


def near(rng, good):
    """A value that the program may take: the good number times something, with its type."""
    try:
        value = int(good)
        return str(value + rng.choice([-1, 1, 10, value, 7 * value]))
    except ValueError:
        pass
    try:
        return repr(float(good) * rng.choice([-1.0, 0.0, 0.5, 0.999, 2.0, 10.0, 1e3, 1e-6, 1e6]))
    except ValueError:
        return rng.choice(['true', 'false', '"off"', '"require"', good])


def mutated(rng, data):
    """Bytes changed: flipped, cut, doubled, zeroed, overwritten with a piece from elsewhere."""
    data = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 5, 20])):
        data = data or bytearray(b'x')
        at, length = rng.randrange(len(data)), rng.choice([1, 2, 4, 8, 100, 5000])
        other = rng.randrange(len(data))
        change = rng.randrange(6)
        if change == 0:
            data[at] ^= 1 << rng.randrange(8)
        elif change == 1:
            data[at:at + length] = rng.randbytes(length)
        elif change == 2:
            del data[at:at + length]
        elif change == 3:
            data[at:at] = data[other:other + length]
        elif change == 4:
            data[at:at + length] = bytes([rng.choice([0, 255, 32, 91, 123])]) * length
        else:
            del data[max(at, 1):]
    return bytes(data)


def mutated_text(rng, text):
    """Numbers and words of a text file changed, or its bytes."""
    if rng.random() < 0.3:
        return mutated(rng, text.encode())
    words = text.split(' ')
    for _ in range(rng.choice([1, 2, 5])):
        at = rng.randrange(len(words))
        quote = '"' if words[at].count('"') == 2 else ''
        change = rng.randrange(4)
        if change == 0:
            words[at] = number(rng)
        elif change == 1:
            words[at] = words[at].split('=')[0] + '=' + quote + number(rng) + quote
        elif change == 2:
            words[at] = words[rng.randrange(len(words))]
        else:
            words[at] *= rng.choice([0, 2, 3000])
    return ' '.join(words).encode(errors='replace')


class Inputs:
    """Makes them, from what the programs themselves wrote and from the files of the tree."""

    def __init__(self, seeds):
        self.seeds = seeds  # name -> bytes of good files
        self.keys = [line.split(' = ', 1) for line in seeds['config.toml'].decode().splitlines() if ' = ' in line]
        self.kinds = [(self.settings, 8), (self.robot, 4), (self.terrain, 2), (self.policy, 4), (self.commands, 3),
                      (self.recording, 5), (self.command_line, 6), (self.signal, 2), (self.environment, 3),
                      (self.pause, 1), (self.dds, 3), (self.operator, 2), (self.evaluate, 1)]

    def draw(self, rng, folder):
        """One input; its files lie in `folder`, in which it runs."""
        kinds, weights = zip(*self.kinds)
        return rng.choices(kinds, weights)[0](rng, folder)

    def settings(self, rng, folder):
        arguments, broken = [], False
        for _ in range(rng.choice([1, 1, 2, 3])):
            key, good = rng.choice(self.keys)
            value = number(rng) if rng.random() < 0.4 else near(rng, good)
            if rng.random() < 0.15:
                key = rng.choice([key + 'x', key.split('.')[0], key + '.x', '.' + key, 'x', key.upper(), 'a.' * 5000])
                broken = broken or value != '{}'  # an empty table sets nothing
            arguments += ['--set', f'{key}={value}']
        if rng.random() < 0.3:
            (folder / 'more.toml').write_bytes(mutated_text(rng, self.seeds['config.toml'].decode()))
            arguments += ['--config', 'more.toml']
        return Input('settings', ['sandrunner', *SHORT, *arguments], broken)

    def robot(self, rng, folder):
        urdf, text = self.seeds['raibo.urdf'], self.seeds['raibo.toml']
        which = rng.random()
        (folder / 'raibo.urdf').write_bytes(mutated_text(rng, urdf.decode()) if which < 0.6 else urdf)
        (folder / 'raibo.toml').write_bytes(mutated_text(rng, text.decode()) if which > 0.5 else text)
        return Input('robot', ['sandrunner', *SHORT, '--robot', 'raibo.toml'])

    def terrain(self, rng, folder):
        (folder / 'ground.toml').write_bytes(mutated_text(rng, self.seeds['dry-sand.toml'].decode()))
        return Input('terrain', ['sandrunner', *SHORT, '--terrain', 'ground.toml'])

    def policy(self, rng, folder):
        data = self.seeds['raibo.safetensors']
        header = int.from_bytes(data[:8], 'little')
        draw, broken = rng.random(), False
        if draw < 0.5:  # the header's length stays right
            text = mutated_text(rng, data[8:8 + header].decode())
            data = len(text).to_bytes(8, 'little') + text + data[8 + header:]
        elif draw < 0.7:
            data, broken = data[:rng.randrange(len(data))], True
        elif draw < 0.8:
            data = rng.randbytes(8) + data[8:]
        else:
            data = mutated(rng, data)
        (folder / 'p.safetensors').write_bytes(data)
        command = rng.choice([['sandrunner', *SHORT, '--policy', 'p.safetensors'],
                              ['sandrunner-policy', 'info', 'p.safetensors'],
                              ['sandrunner-policy', 'envelope', 'p.safetensors', '--forward', number(rng)],
                              ['sandrunner-policy', 'import', 'p.safetensors', '--out', 'q.safetensors']])
        if broken and rng.random() < 0.3:
            command = ['sandrunner-evaluate', '--policy', 'p.safetensors', '--runs', '1', '--only', 'straight']
        elif rng.random() < 0.15:
            (folder / 'p.safetensors').rename(folder / 'ours-1.safetensors')
            command = ['sandrunner-study', '--from', '.', '--out', 'out', '--only', 'E6', '--runs', '1']
        return Input('policy', command, broken)

    def commands(self, rng, folder):
        rows = ['t_s,vx,vy,wz'] + [f'{0.01 * i},{rng.uniform(-1, 4):.3g},0,{rng.uniform(-1, 1):.3g}' for i in range(9)]
        if rng.random() < 0.6:
            row = rng.randrange(len(rows))
            cells = rows[row].split(',')
            cells[rng.randrange(len(cells))] = number(rng)
            rows[row] = ','.join(cells)
            data = '\n'.join(rows).encode(errors='replace')
        else:
            data = mutated(rng, '\n'.join(rows).encode())
        (folder / 'c.csv').write_bytes(data)
        name = 'c.csv' if rng.random() < 0.8 else ','.join(number(rng) for _ in range(rng.randint(0, 5)))
        return Input('commands', ['sandrunner', *SHORT, '--command', name])

    def recording(self, rng, folder):
        data, broken = self.seeds['run.mcap'], True
        draw = rng.random()
        if draw < 0.3:
            data = data[:rng.randrange(len(data))]
        elif draw < 0.5:
            at = rng.randrange(len(data))
            data = data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1:]
        elif draw < 0.8:
            data = mutated(rng, data)
            broken = data != self.seeds['run.mcap']
        else:
            broken = False
        (folder / 'r.mcap').write_bytes(data)
        command = ['sandrunner-replay', 'r.mcap']
        for option in ['--from', '--to', '--plot', '--set']:
            if rng.random() < 0.15:
                key, good = rng.choice(self.keys)
                value = {'--plot': 'plots', '--set': f'{key}={rng.choice([good, number(rng)])}'}
                command += [option, value.get(option, number(rng))]
                broken = broken and option != '--to'  # the damage may lie behind it
        return Input('recording', command, broken)

    def command_line(self, rng, folder):
        options = {
            'sandrunner': ['--policy', '--robot', '--terrain', '--command', '--dds-security', '--duration', '--start',
                           '--clock', '--seed', '--config', '--set', '--out', '--record'],
            'sandrunner-replay': ['--from', '--to', '--plot', '--set'],
            'sandrunner-policy': ['info', 'import', 'envelope', '--out'],
            'sandrunner-evaluate': ['--policy', '--against', '--robot', '--out', '--threads', '--runs', '--grid-runs',
                                    '--seed', '--only', '--torque-speed-line'],
            'sandrunner-study': ['--from', '--out', '--only', '--seeds', '--runs', '--threads', '--contact'],
            'sandrunner-ctl': ['--domain', '--interface', '--security', '--cmd-vel', 'cmd', 'mode', 'watch']}
        program = rng.choice(list(options))
        words = ['', 'x', '-', '--', '/', '/dev/null', '/dev/zero', '.', 'no/such', '0,0,0', 'a' * 9000, '--help-all']
        command = [program] + (SHORT if program == 'sandrunner' else [])
        for _ in range(rng.randint(0, 4)):
            command.append(rng.choice(options[program]))
            if rng.random() < 0.8:
                command.append(rng.choice([rng.choice(words), number(rng)]))
        command.append(rng.choice(['--no-such-option', '--set=', '--seeed', '-x', '--duration=', '--out', '--', '']))
        return Input('command line', command, broken=command[-1].startswith('--no-such') and '--' not in command)

    def long_run(self, rng):
        realtime = rng.random() < 0.5
        command = ['sandrunner', '--out', 'out', '--record', 'rec', '--start', rng.choice(['walk', 'stand']),
                   '--duration', '0.4' if realtime else '1']
        return command + (['--clock', 'realtime'] if realtime else [])

    def signal(self, rng, folder):
        plan = [(rng.uniform(0.0, 0.4), rng.choice(SIGNALS)) for _ in range(rng.choice([1, 1, 2]))]
        return Input('signal', self.long_run(rng), signals=sorted(plan))

    def pause(self, rng, folder):
        plan, time_s = [], 0.0
        for _ in range(rng.randint(1, 5)):
            time_s += rng.uniform(0.0, 0.1)
            plan.append((time_s, signal.SIGSTOP))
            time_s += rng.uniform(0.001, 0.2)
            plan.append((time_s, signal.SIGCONT))
        return Input('pause', self.long_run(rng), signals=plan)

    def live_robot(self, rng):
        """One that operators command; it stands up in no time, so that they get it to walk."""
        settings = {'dds.enabled': 'true', 'dds.domain': DOMAIN, 'controller.stand.fold_s': 0.02,
                    'controller.stand.extend_s': 0.02, 'controller.stand.max_speed_radps': 20,
                    'controller.damping.fault_s': 0.5, **{f'controller.{key}': BOUNDS[key] for key in BOUNDS}}
        if rng.random() < 0.2:
            settings['dds.cmd_vel'] = '"twist_stamped"'
        if rng.random() < 0.2:
            settings['dds.stale_s'] = rng.choice([0.01, 10])
        if rng.random() < 0.8:  # it takes more time than all the rest
            settings['realtime.lock_memory'] = '"off"'
        command = ['sandrunner', '--clock', 'realtime', '--command', 'dds']
        return command + [word for key in settings for word in ['--set', f'{key}={settings[key]}']]

    def attacker(self, rng, time_s):
        return ['dds_attacker', DOMAIN, str(rng.randrange(10**9)), str(time_s), *map(str, BOUNDS.values())]

    def dds(self, rng, folder):
        return Input('dds', self.attacker(rng, 0.2), beside=[self.live_robot(rng)])

    def operator(self, rng, folder):
        """sandrunner-ctl with a robot, which others may be at as well."""
        topics = ['rt/odom', 'rt/joint_states', 'rt/imu/data', 'rt/tf', 'rt/diagnostics', 'rt/robot_description',
                  'sandrunner/ticks', 'sandrunner/mode_reply', 'rt/cmd_vel', 'x', '']
        modes = ['arm', 'stand', 'walk', 'stop', 'lie', 'damp', 'disarm', 'reset_fault']
        velocity = [number(rng) if rng.random() < 0.1 else f'{rng.uniform(-1, 1):.3g}' for _ in range(3)]
        words = rng.choice([['mode', rng.choice(modes)], ['cmd', '--for', '0.1', *velocity],
                            ['watch', rng.choice(topics), '--count', str(rng.randint(0, 50))],
                            ['drive'], ['status', '--once']])
        if rng.random() < 0.2:
            words.insert(rng.randint(0, len(words)), rng.choice([number(rng), '--for', '--once', '--', '--count']))
        if rng.random() < 0.1:
            words += ['--cmd-vel', 'twist_stamped']
        beside = [self.live_robot(rng)] + ([self.attacker(rng, 10)] if rng.random() < 0.5 else [])
        return Input('operator', ['sandrunner-ctl', '--domain', DOMAIN, *words], signals=[(0.3, signal.SIGINT)],
                     beside=beside)

    def evaluate(self, rng, folder):
        (folder / 'p.safetensors').write_bytes(self.seeds['raibo.safetensors'])
        command = ['sandrunner-evaluate', '--policy', 'p.safetensors', '--runs', '1', '--grid-runs', '1',
                   '--only', rng.choice(['straight', 'grid', 'turn', 'robust']), '--threads', str(rng.randint(1, 3)),
                   '--seed', str(rng.randrange(1, 1000))]
        if rng.random() < 0.3:
            command += ['--out', 'out', '--torque-speed-line', rng.choice(['on', 'off'])]
        return Input('evaluate', command, signals=[(0.2, signal.SIGTERM)] if rng.random() < 0.5 else [])

    def environment(self, rng, folder):
        command = ['sandrunner', *SHORT, '--out', 'out', '--record', 'rec']
        if rng.random() < 0.3:
            (folder / 'r.mcap').write_bytes(self.seeds['run.mcap'])
            command = ['sandrunner-replay', 'r.mcap', '--plot', 'plots']
        one = Input('environment', command)
        one.shell = rng.choice(['', 'exec <&-', 'exec >&-', 'exec <&- >&-', 'exec >/dev/full', 'umask 777',
                                # At 0 not even standard error, a file here, takes a line. The
                                # parser of the TOML library takes a stack of 450 kB.
                                f'ulimit -f {rng.randint(1, 500)}', f'ulimit -s {rng.randint(500, 1000)}',
                                f'ulimit -n {rng.randint(4, 20)}', 'mkdir -p out rec; chmod 555 out rec',
                                'mkdir out; mkdir out/run.csv', 'touch out rec plots', 'ln -s /dev/full out',
                                'trap "" INT TERM HUP PIPE'])
        one.other_user = 'chmod' in one.shell
        one.environment = rng.choice([{}, {'LANG': 'de_DE.UTF-8', 'LC_ALL': 'de_DE.UTF-8'}, {'LC_ALL': 'xx_YY'},
                                      {'TERM': ''}, {'HOME': '/no/such'}, {'TMPDIR': '/no/such'}, {'COLUMNS': '-1'},
                                      {'TZ': 'x' * 999}, {'CYCLONEDDS_URI': '<x'}])
        return one
