// SPDX-License-Identifier: MIT
//
// What the program that made the page has put into it: which scene, and who draws it.

export interface Config {
    name: string; // of the file
    url?: string; // the .octv file, beside the page
    inline?: boolean; // the file is in the page, as base64 in #octavo-scene
    render?: {
        url: string; // draws pictures; see remote_painter.ts
        pick: string; // finds voxels
        low: [number, number, number]; // the box of all voxels, world space
        high: [number, number, number];
    };
}

export function readConfig(): Config | undefined {
    const element = document.getElementById('octavo-config');
    return element ? (JSON.parse(element.textContent ?? '') as Config) : undefined;
}

/** The bytes of #octavo-scene, which is removed: it takes more memory than they do. */
export function takeInlineScene(): Uint8Array<ArrayBuffer> {
    const element = document.getElementById('octavo-scene')!;
    const text = element.textContent!.trim();
    element.remove();
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; i += 1) bytes[i] = binary.charCodeAt(i);
    return bytes;
}
