// SPDX-License-Identifier: BSD-3-Clause
// The robot's own time, where a server lets this page hold it, step it and change its pace.
const element = (id) => document.getElementById(id);

export function makeRobotTime(live) {
  const show = () => {
    element('robot-time').hidden = !(live.hasPace && live.mayTouch) || live.state.ended;
    element('hold').textContent = live.state.paused ? 'go on' : 'freeze robot';
    if (document.activeElement !== element('pace')) element('pace').value = String(live.state.rate);
  };
  element('hold').onclick = () => live.say({ say: 'pause', on: !live.state.paused });
  element('tick').onclick = () => live.say({ say: 'step', ticks: 1 });
  element('policy-step').onclick = () => live.say({ say: 'step', ticks: 40 });
  element('pace').onchange = () => live.say({ say: 'pace', rate: Number(element('pace').value) });
  return show;
}
