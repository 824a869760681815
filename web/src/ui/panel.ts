// SPDX-License-Identifier: MIT
//
// The controls of the panel, and the settings that they stand for. A control is there only where it
// does something for this file.
import { type Mode, type NumberSetting, type Settings, kRanges, kShadows } from '../view/settings';
import { byId } from './dom';
import { rounded } from './numbers';

const kModeLabels: Record<Mode, string> = { shaded: 'Shaded', normals: 'Normals', levels: 'Levels', steps: 'Steps', color: 'Colour' };
const kShadowLabels = { none: 'None', hard: 'Hard', soft: 'Soft' };
const kUpLabels = { y: 'Y', z: 'Z' };

/** What the file and the machine allow. */
export interface Offers {
    modes: readonly Mode[];
    cameras: string[];
    lights: { number: number; name: string }[];
    depth: number;
    sceneDiagonal: number; // world units; 0: not known yet
    storedLight: boolean; // the file has light of its cells
    sunLight: boolean; // the light is the one that the panel turns
    drawnHere: boolean; // by this machine's GPU
}

type Sliders = Exclude<NumberSetting, 'light' | 'memory'>;
const kSliders: Sliders[] = ['sunAzimuth', 'sunElevation', 'sunSize', 'ambientRadius', 'exposure', 'detail', 'finestLevel', 'scale', 'samples'];

export class Panel {
    private settings: Settings;
    private offers: Offers | undefined;

    constructor(
        settings: Settings,
        private readonly changed: (settings: Settings) => void,
        private readonly chooseCamera: (index: number) => void,
    ) {
        this.settings = settings;
        for (const key of kSliders) this.bindSlider(key);
        for (const key of ['ambient', 'smooth', 'stored'] as const) {
            byId<HTMLInputElement>(key).addEventListener('change', (event) => {
                this.set({ [key]: (event.target as HTMLInputElement).checked });
            });
        }
        byId<HTMLSelectElement>('lights').addEventListener('change', (event) => {
            this.set({ light: Number((event.target as HTMLSelectElement).value) });
        });
        byId<HTMLSelectElement>('cameras').addEventListener('change', (event) => {
            this.chooseCamera(Number((event.target as HTMLSelectElement).value));
        });
        const memory = byId<HTMLInputElement>('memory');
        memory.min = String(kRanges.memory.least);
        memory.max = String(kRanges.memory.most);
        memory.step = 'any';
        memory.addEventListener('change', () => {
            const value = Number(memory.value);
            if (Number.isFinite(value) && value >= kRanges.memory.least) {
                this.set({ memory: Math.min(value, kRanges.memory.most) });
            } else {
                this.show(this.settings);
            }
        });
        this.bindChoice('shadows', kShadows.map((value) => [value, kShadowLabels[value]]), (value) => {
            this.set({ shadows: value as Settings['shadows'] });
        });
        this.bindChoice('up', Object.entries(kUpLabels), (value) => this.set({ up: value as Settings['up'] }));
    }

    /** What part of a picture, at its left, the panel leaves clear; all of it where it does not lie at the side. */
    clearOf(picture: DOMRect): number {
        const panel = byId('panel').getBoundingClientRect();
        const beside = panel.width > 0 && panel.left > picture.left + 0.5 * picture.width;
        return beside ? Math.min(1, (panel.left - picture.left) / picture.width) : 1;
    }

    /** What there is to choose from. */
    offer(offers: Offers): void {
        const before = this.offers;
        this.offers = offers;
        if (before?.modes.join() !== offers.modes.join()) {
            this.bindChoice('modes', offers.modes.map((mode) => [mode, kModeLabels[mode]]), (value) => {
                this.set({ mode: value as Mode });
            });
            byId('last-mode').textContent = String(offers.modes.length);
        }
        const named = (names: string[], select: string, first?: [string, string]): void => {
            const options = names.map((name, i): [string, string] => [String(i), name]);
            this.fillSelect(select, first ? [first, ...options] : options);
        };
        if (before?.cameras.join() !== offers.cameras.join()) named(offers.cameras, 'cameras', ['-1', 'Free']);
        this.fillSelect('lights', [['-1', 'Sun of the viewer'], ...(offers.lights.length > 1 ? [['-2', `All ${offers.lights.length}`] as [string, string]] : []), ...offers.lights.map(({ number, name }): [string, string] => [String(number), name])]);
        byId('cameras-row').hidden = offers.cameras.length === 0;
        byId('lights-row').hidden = offers.lights.length === 0;
        byId('row-sunAzimuth').hidden = byId('row-sunElevation').hidden = !offers.sunLight;
        for (const id of ['row-memory', 'row-samples']) byId(id).hidden = !offers.drawnHere;
        byId('modes').hidden = offers.modes.length < 2;
        byId<HTMLInputElement>('finestLevel').max = String(offers.depth);
        this.show(this.settings);
    }

    /** Shows these settings; tells nobody. */
    show(settings: Settings): void {
        this.settings = settings;
        for (const key of kSliders) {
            const input = byId<HTMLInputElement>(key);
            const value = key === 'finestLevel' ? Math.min(settings[key], this.offers?.depth ?? 17) : settings[key];
            input.value = String(value);
            this.showValue(key, value);
        }
        byId<HTMLInputElement>('ambient').checked = settings.ambient;
        byId<HTMLInputElement>('smooth').checked = settings.smooth;
        byId<HTMLInputElement>('stored').checked = settings.stored;
        byId<HTMLInputElement>('memory').value = rounded(settings.memory, 6);
        byId<HTMLSelectElement>('lights').value = String(settings.light);
        this.showChoice('modes', settings.mode);
        this.showChoice('shadows', settings.shadows);
        this.showChoice('up', settings.up);
        byId('row-ambientRadius').hidden = !settings.ambient;
        byId('row-sunSize').hidden = settings.shadows !== 'soft' || this.offers?.sunLight === false;
        for (const element of document.querySelectorAll<HTMLElement>('[data-for]')) {
            element.hidden = !element.dataset.for!.split(' ').includes(settings.mode);
        }
        const byCells = settings.stored && this.offers?.storedLight === true;
        // Another machine chooses the level of what it shades; stored light is for voxels.
        const elsewhere = this.offers?.drawnHere === false && settings.mode === 'shaded';
        byId('row-finestLevel').hidden = elsewhere;
        byId('row-detail').hidden = elsewhere || (byCells && settings.mode === 'shaded');
        byId('row-stored').hidden = this.offers?.storedLight !== true;
        byId('direct-light').hidden = byCells;
        const legend = settings.mode === 'levels' || settings.mode === 'steps';
        byId('legend').hidden = !legend;
        byId('legend-low').textContent = settings.mode === 'levels' ? 'root' : '0 cells';
        byId('legend-high').textContent = settings.mode === 'levels' ? `voxels, level ${this.offers?.depth ?? ''}` : '128 or more';
    }

    /** No camera of the file any more: the user has moved. */
    showFreeCamera(): void {
        byId<HTMLSelectElement>('cameras').value = '-1';
    }
    showCamera(index: number): void {
        byId<HTMLSelectElement>('cameras').value = String(index);
    }

    private set(part: Partial<Settings>): void {
        this.show({ ...this.settings, ...part });
        this.changed(this.settings);
    }

    private bindSlider(key: Sliders): void {
        const input = byId<HTMLInputElement>(key);
        const range = kRanges[key];
        // An output can have a label as well, and would take this one.
        input.closest('label')!.htmlFor = key;
        input.min = String(range.least);
        input.max = String(range.most);
        input.step = String(range.step);
        input.addEventListener('input', () => this.set({ [key]: Number(input.value) }));
    }

    private showValue(key: Sliders, value: number): void {
        const input = byId<HTMLInputElement>(key);
        const label = this.valueText(key, value);
        input.closest('label')!.querySelector('output')!.textContent = label;
        input.setAttribute('aria-valuetext', label);
        const part = (value - Number(input.min)) / (Number(input.max) - Number(input.min));
        input.style.setProperty('--at', `${100 * Math.max(0, Math.min(1, part))}%`);
    }

    private valueText(key: Sliders, value: number): string {
        const depth = this.offers?.depth ?? 17;
        const diagonal = this.offers?.sceneDiagonal ?? 0;
        switch (key) {
            case 'sunAzimuth':
            case 'sunElevation':
                return `${Math.round(value)}°`;
            case 'sunSize':
                return `${rounded(value)}°`;
            case 'ambientRadius':
                return diagonal > 0 ? rounded(0.01 * value * diagonal) : `${rounded(value)} %`;
            case 'exposure':
                return `${value > 0 ? '+' : ''}${rounded(value)}`;
            case 'detail':
                return value === 0 ? 'a voxel' : `${rounded(value)} px`;
            case 'finestLevel':
                return `${value} · ${2 ** value}³${value === depth ? '' : ` of ${2 ** depth}³`}`;
            case 'samples':
                return String(value);
            case 'scale':
                return `${Math.round(value)} %`;
        }
    }

    /** A row of buttons of which one is chosen: arrow keys move, as in any radio group. */
    private bindChoice(id: string, options: (readonly [string, string])[], choose: (value: string) => void): void {
        const group = byId(id);
        group.replaceChildren(
            ...options.map(([value, label]) => {
                const button = document.createElement('button');
                button.type = 'button';
                button.setAttribute('role', 'radio');
                button.dataset.value = value;
                button.textContent = label;
                button.addEventListener('click', () => choose(value));
                return button;
            }),
        );
        group.onkeydown = (event) => {
            const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
            if (!step) return;
            event.preventDefault();
            const buttons = [...group.querySelectorAll('button')];
            const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
            const next = buttons[(at + step + buttons.length) % buttons.length]!;
            next.focus();
            next.click();
        };
    }

    private showChoice(id: string, value: string): void {
        for (const button of byId(id).querySelectorAll('button')) {
            const chosen = button.dataset.value === value;
            button.setAttribute('aria-checked', String(chosen));
            button.tabIndex = chosen ? 0 : -1;
        }
    }

    private fillSelect(id: string, options: [string, string][]): void {
        const select = byId<HTMLSelectElement>(id);
        if ([...select.options].map((o) => `${o.value}=${o.text}`).join() === options.map((o) => o.join('=')).join()) return;
        const { value } = select;
        select.replaceChildren(...options.map(([key, label]) => new Option(label, key)));
        select.value = value;
    }
}
