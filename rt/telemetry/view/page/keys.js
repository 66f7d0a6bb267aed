// SPDX-License-Identifier: BSD-3-Clause

/** Whether a key is meant for the page, not for the browser or for a field to write in. */
export const isForPage = (event) => !event.ctrlKey && !event.altKey && !event.metaKey && !/^(SELECT|INPUT)$/.test(event.target.tagName);
