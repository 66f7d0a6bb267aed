// SPDX-License-Identifier: BSD-3-Clause
// Colours of what is drawn on canvases, for a light or a dark page; page.css has the others. Text has a contrast of at
// least 4.5 to its ground, so names are not written in the colours of their lines.
const kDark = matchMedia('(prefers-color-scheme: dark)').matches;

export const kTheme = kDark
  ? { ink: '#e6eaee', faint: '#9aa5b0', zero: '#55606b', grid: '#262d34', limit: '#ff7469',
    grey: '#9aa5b0', blue: '#6fb1ee', orange: '#f59a45', green: '#4cc3b5', legs: ['#5d93c9', '#a9d3fa', '#b9752a', '#ffd09a'] }
  : { ink: '#22282f', faint: '#5b6670', zero: '#b9c2ca', grid: '#e8ecef', limit: '#d8322f',
    grey: '#8a949e', blue: '#1d5c99', orange: '#f07c12', green: '#2a9d8f', legs: ['#93c2ee', '#12518f', '#f2bd7c', '#a84a08'] };
