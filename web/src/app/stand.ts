// SPDX-License-Identifier: MIT
//
// Where the viewer stands and what is asked for: by the file, the link, the panel and the hand that
// moves, the latest of which counts. The panel and the address say the same.
import { Address } from '../ui/address';
import type { Offers } from '../ui/panel';
import { Panel } from '../ui/panel';
import { type Axes, type Camera, type Frame, axesOf, defaultCamera, forwardOf, framing, fromStored } from '../view/camera';
import { kViewersSun, storedLight, storedSun } from '../view/lights';
import { linkOf, readLink } from '../view/link';
import { type Settings, kDefaults } from '../view/settings';
import { scale } from '../view/vec';
import type { Scene } from './scene';

export interface StandHost {
    scene(): Scene | undefined;
    canvas: HTMLCanvasElement;
    offers(settings: Settings): Offers;
    /** The picture is another one. */
    changed(): void;
    /** The picture is the same with other colours. */
    recoloured(): void;
    /** The scene may take this much GPU memory, MiB. */
    memoryChanged(): void;
}

export class Stand {
    camera: Camera | undefined;
    settings: Settings;
    readonly address: Address;
    private base: Settings = kDefaults; // what a link need not say
    private cameraIsOurs = true; // nobody has moved it yet
    private readonly panel: Panel;

    constructor(private readonly host: StandHost) {
        this.settings = { ...kDefaults, ...readLink(location.hash).settings };
        this.address = new Address(() => linkOf(this.camera, this.settings, this.base));
        this.panel = new Panel(
            this.settings,
            (settings) => this.change(settings),
            (index) => this.chooseCamera(index),
        );
        window.addEventListener('hashchange', () => this.followLink());
    }

    get axes(): Axes {
        return axesOf(this.settings.up);
    }

    /** There is more, or less, to choose from. */
    offer(): void {
        this.panel.offer(this.host.offers(this.settings));
    }

    /** A new file: its own light, and what the link says. @param canSmooth  quickly enough */
    begin({ metadata }: Scene, canSmooth: boolean): void {
        const light = storedLight(metadata);
        this.base = {
            ...kDefaults,
            ...storedSun(metadata, light, this.axes),
            light,
            smooth: kDefaults.smooth && canSmooth,
            stored: metadata.storedLight !== undefined,
            finestLevel: metadata.grid.depth,
        };
        const link = readLink(location.hash);
        this.settings = { ...this.base, ...link.settings, memory: this.settings.memory };
        this.camera = link.camera;
        this.cameraIsOurs = !link.camera;
        this.panel.show(this.settings);
        this.offer();
    }

    /** Where a scene is first seen from, and the sun with it: as octavo render has them. Until somebody moves. */
    place(): void {
        const scene = this.host.scene();
        if (!this.cameraIsOurs || !scene?.box) return;
        const stored = scene.metadata.cameras[0];
        this.camera = stored ? fromStored(stored, this.axes, scene.box) : defaultCamera(scene.box, this.axes, this.frame);
        if (stored) this.panel.showCamera(0);
        if (readLink(location.hash).settings.sunAzimuth === undefined && this.settings.light === kViewersSun) {
            const behind = this.camera.azimuth + Math.PI;
            const azimuth = Math.round((behind * 180) / Math.PI - 55);
            this.settings = { ...this.settings, sunAzimuth: ((azimuth + 540) % 360) - 180 };
            this.panel.show(this.settings);
        }
    }

    moveTo(camera: Camera): void {
        if (!camera.eye.every((value) => Math.abs(value) < 1e12)) return;
        this.camera = camera;
        this.cameraIsOurs = false;
        this.panel.showFreeCamera();
        this.host.changed();
        this.address.follow();
    }

    frameAll(): void {
        const box = this.host.scene()?.box;
        if (!box || !this.camera) return;
        const towardsEye = scale(-1, forwardOf(this.camera, this.axes));
        this.moveTo(framing(box, this.axes, this.frame, towardsEye, this.camera.verticalFov));
    }

    /** The n-th of what the picture can show. @returns whether there is one */
    chooseMode(index: number): boolean {
        const mode = this.host.offers(this.settings).modes[index];
        if (!mode) return false;
        this.panel.show({ ...this.settings, mode });
        this.change({ ...this.settings, mode });
        return true;
    }

    private chooseCamera(index: number): void {
        const scene = this.host.scene();
        const stored = scene?.metadata.cameras[index];
        if (!stored || !scene?.box) return;
        this.moveTo(fromStored(stored, this.axes, scene.box));
        this.panel.showCamera(index);
    }

    private change(settings: Settings): void {
        const before = this.settings;
        const turned = (['sunAzimuth', 'sunElevation', 'sunSize'] as const).some((key) => before[key] !== settings[key]);
        // A sun of the file that is turned is the viewer's own from there on.
        if (turned && settings.light !== kViewersSun) {
            settings = { ...settings, light: kViewersSun };
            this.panel.show(settings);
        }
        this.settings = settings;
        const box = this.host.scene()?.box;
        if (before.up !== settings.up && box) {
            this.camera = defaultCamera(box, this.axes, this.frame);
            this.cameraIsOurs = false;
        }
        if (before.light !== settings.light) this.offer();
        if (before.memory !== settings.memory) this.host.memoryChanged();
        if (onlyLook(before, settings)) this.host.recoloured();
        else this.host.changed();
        this.address.follow();
    }

    private followLink(): void {
        const link = readLink(location.hash);
        const before = this.settings;
        this.settings = { ...this.base, ...link.settings };
        if (link.camera) {
            this.camera = link.camera;
            this.cameraIsOurs = false;
        }
        this.panel.show(this.settings);
        this.offer();
        if (before.memory !== this.settings.memory) this.host.memoryChanged();
        this.host.changed();
    }

    private get frame(): Frame {
        const { canvas } = this.host;
        return { aspect: canvas.width / canvas.height, clear: this.panel.clearOf(canvas.getBoundingClientRect()) };
    }
}

/** Nothing that rays depend on has changed. */
function onlyLook(before: Settings, after: Settings): boolean {
    return before.mode === after.mode && JSON.stringify({ ...before, exposure: 0 }) === JSON.stringify({ ...after, exposure: 0 });
}
