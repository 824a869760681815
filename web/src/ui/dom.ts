// SPDX-License-Identifier: MIT

/** The element with this id, which index.html has. */
export function byId<T extends HTMLElement>(id: string): T {
    const element = document.getElementById(id);
    if (!element) throw new Error(`The page has no #${id}`);
    return element as T;
}

/** Fills a list of terms and values. */
export function fillFacts(list: HTMLElement, facts: [string, string][]): void {
    const wanted = facts.flat();
    const there = [...list.children];
    if (there.length !== wanted.length) {
        list.replaceChildren(...wanted.map((_, i) => document.createElement(i % 2 === 0 ? 'dt' : 'dd')));
    }
    [...list.children].forEach((element, i) => {
        if (element.textContent === wanted[i]) return;
        element.textContent = wanted[i]!;
        if (/^#[0-9a-f]{6}$/.test(wanted[i]!)) element.prepend(swatch(wanted[i]!));
    });
}

/** A square of a colour, set by script since the page's policy admits no style in the text. */
function swatch(color: string): HTMLElement {
    const square = document.createElement('span');
    square.className = 'swatch';
    square.style.background = color;
    return square;
}
