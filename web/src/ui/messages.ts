// SPDX-License-Identifier: MIT
//
// What the page says: a notice that stays, a line that passes, the bar of what is loading.
import type { FaultKind } from '../octv/errors';
import { byId } from './dom';

let toastTimer = 0;

export function notice(title: string, text: string, help = ''): void {
    byId('notice').hidden = false;
    byId('notice-title').textContent = title;
    byId('notice-text').textContent = text;
    byId('notice-help').textContent = help;
    byId('loading').hidden = true;
}

export function hideNotice(): void {
    byId('notice').hidden = true;
}

/** @param shown  a part of the file is there, and shown */
export function faultNotice(kind: FaultKind, message: string, shown: boolean): void {
    const titles: Record<FaultKind, string> = {
        damaged: 'This file is damaged',
        unsupported: 'This file needs a newer viewer',
        unreachable: 'The scene did not arrive',
        limit: 'This scene is too large here',
    };
    const helps: Record<FaultKind, string> = {
        damaged: shown ? 'What came before the damage is shown. Build or copy the file again.' : 'Build or copy the file again.',
        unsupported: 'Open it with the program that wrote it.',
        unreachable: 'Start octavo view again, or drop the file on this page.',
        limit: 'Raise the GPU memory in the settings, build it at a lower resolution, or let another machine draw: octavo view --render-here.',
    };
    notice(titles[kind], message, helps[kind]);
}

export function noWebGlNotice(): void {
    notice(
        'This browser has no WebGL 2',
        'The viewer draws with WebGL 2, which this browser lacks or has turned off.',
        'Update the browser or its graphics driver, turn hardware acceleration on, or run octavo view --render-here.',
    );
}

export function noSceneNotice(): void {
    notice('Open a scene', 'Drop an .octv file on this page, or choose one.', 'octavo build makes them from meshes.');
}

export function fromDiskNotice(): void {
    notice(
        'This page was opened from a disk',
        'Browsers do not let such a page read the files beside it. Serve the folder with any web server, or drop the .octv file here.',
        'octavo export FILE --html PAGE.html writes one file that can be opened like this.',
    );
}

export function toast(text: string, milliseconds = 2500): void {
    const element = byId('toast');
    element.textContent = text;
    element.classList.add('shown');
    clearTimeout(toastTimer);
    toastTimer = window.setTimeout(() => element.classList.remove('shown'), milliseconds);
}

/** To a screen reader, and to nobody else. */
export function say(text: string): void {
    byId('spoken').textContent = text;
}

/** @param part  0 to 1 */
export function showLoading(text: string, part: number, levels: string): void {
    byId('loading').hidden = false;
    byId<HTMLProgressElement>('bytes').value = part;
    byId('loading-text').textContent = text;
    byId('loading-levels').textContent = levels;
}

export function hideLoading(): void {
    byId('loading').hidden = true;
}
