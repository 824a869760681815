// SPDX-License-Identifier: MIT
//
// The page: one scene, where the viewer stands, what is asked for, and who draws it.
import { type Config, readConfig, takeInlineScene } from './config';
import { GpuPainter } from './gpu_painter';
import type { CellLayout } from './octv/cells';
import type { CellBox } from './octv/content_bounds';
import type { FaultKind } from './octv/errors';
import type { Metadata } from './octv/metadata';
import type { Origin, Report } from './octv/worker';
import type { Painter, View } from './painter';
import { RemotePainter } from './remote_painter';
import { type Scene, hasStoredLight, openLevel, sceneFacts } from './scene';
import { SceneLoader } from './scene_loader';
import { Address } from './ui/address';
import { bindButtons, bindDropping, download, togglePanel } from './ui/buttons';
import { byId, fillFacts } from './ui/dom';
import { faultNotice, hideLoading, hideNotice, notice, showLoading, toast } from './ui/messages';
import { megabytes, rounded } from './ui/numbers';
import { type Offers, Panel } from './ui/panel';
import { startTheme } from './ui/theme';
import { type FoundCell, centreOf, shortFacts, voxelFacts } from './ui/voxel_facts';
import { type Axes, type Camera, type Frame, axesOf, defaultCamera, diagonalOf, forwardOf, framing, fromStored } from './view/camera';
import { Controls } from './view/controls';
import { kAllLights, kViewersSun, storedLight, storedSun, usableLights } from './view/lights';
import { linkOf, readLink } from './view/link';
import { type Settings, kDefaults, kModes } from './view/settings';
import { type Vec3, add, length, scale, sub } from './view/vec';

const kMebi = 1024 * 1024;

export class App {
    private readonly canvas = byId<HTMLCanvasElement>('picture');
    private readonly panel: Panel;
    private settings: Settings;
    private base: Settings = kDefaults; // what a link need not say
    private camera: Camera | undefined;
    private cameraIsOurs = true; // nobody has moved it yet
    private scene: Scene | undefined;
    private loader: SceneLoader | undefined;
    private opened: { name: string; origin: Origin } | undefined;
    private config: Config | undefined;
    private painter: Painter | undefined;
    private gpu: GpuPainter | undefined; // the painter, where this machine draws and needs the scene
    private pendingCells: CellLayout | undefined;
    private readonly address = new Address(() => linkOf(this.camera, this.settings, this.base));
    private shownStatistics = 0;

    constructor() {
        const link = readLink(location.hash);
        this.settings = { ...kDefaults, ...link.settings };
        this.panel = new Panel(
            this.settings,
            (settings) => this.changeSettings(settings),
            (index) => this.chooseCamera(index),
        );
        new Controls(this.canvas, {
            camera: () => this.camera,
            axes: () => this.axes,
            sceneSize: () => this.sceneSize,
            voxelSize: () => this.scene?.metadata.grid.voxelSize ?? 1,
            moveTo: (camera) => this.moveTo(camera),
            click: (x, y) => void this.showVoxel(x, y),
            doubleClick: (x, y) => void this.focusOn(x, y),
            speedChanged: (speed) => toast(`Speed ${rounded(speed)} units a second`),
        });
        const open = (name: string, blob: Blob): void => this.open(name, { blob });
        bindButtons({
            frameAll: () => this.frameAll(),
            savePicture: () => void this.savePicture(),
            copyLink: () => void this.address.copy(),
            open,
            chooseMode: (index) => this.chooseMode(index),
        });
        startTheme();
        if (innerWidth <= 720) togglePanel(false);
        window.addEventListener('hashchange', () => this.followLink());
        new ResizeObserver(() => this.resize()).observe(this.canvas);
        this.resize();
        this.config = readConfig();
        if (this.config?.render) {
            this.startRemotePainter(this.config.render);
        } else {
            bindDropping(open); // another machine has its own file
            this.startGpuPainter();
        }
        this.panel.offer(this.offers());
        this.openConfigured();
    }

    private openConfigured(): void {
        const { config } = this;
        if (!this.painter) return this.sayNoWebGl();
        if (!config) {
            notice('Open a scene', 'Drop an .octv file on this page, or choose one.', 'octavo build makes them from meshes.');
            return;
        }
        if (config.inline) return this.open(config.name, { bytes: takeInlineScene() });
        if (location.protocol === 'file:') {
            return notice(
                'This page was opened from a disk',
                'Browsers do not let such a page read the files beside it. Serve the folder with any web server, or drop the .octv file here.',
                'octavo export FILE --html PAGE.html writes one file that can be opened like this.',
            );
        }
        this.open(config.name, { url: new URL(config.url!, location.href).href });
    }

    private open(name: string, origin: Origin): void {
        if (!this.painter) return this.sayNoWebGl();
        this.loader?.cancel();
        this.opened = { name, origin };
        this.scene = undefined;
        hideNotice();
        byId('voxel').hidden = true;
        document.title = `${name} · Octavo`;
        byId('scene-name').textContent = name;
        showLoading('Opening', 0, '');
        this.load();
    }

    private load(): void {
        const { name, origin } = this.opened!;
        this.canvas.dataset.state = 'drawing'; // what is shown is not what was asked for any more
        if (this.scene) this.scene.done = false;
        this.gpu?.dropCells();
        this.loader = new SceneLoader(origin, this.gpu ? this.settings.memory * kMebi : 0, (report) => this.hear(name, origin, report));
    }

    private hear(name: string, origin: Origin, report: Report): void {
        const { scene } = this;
        switch (report.is) {
            case 'opened': {
                const { metadata } = report.facts;
                this.begin(name, origin, metadata, report.facts.fileBytes);
                return;
            }
            case 'progress':
                if (scene) scene.loadedBytes = report.bytes;
                this.showProgress();
                return;
            case 'words':
                this.gpu?.append(report.words);
                return;
            case 'level':
                scene!.loadedLevels = report.level + 1;
                this.showProgress();
                this.redraw();
                return;
            case 'bounds':
                this.learnBounds(report.box);
                return;
            case 'cells':
                this.pendingCells = this.gpu?.reserveCells(report.layout) ? report.layout : undefined;
                if (!this.pendingCells) toast('This GPU has no room for the colours', 8000);
                return;
            case 'cellWords':
                this.gpu?.appendCells(report.words);
                return;
            case 'cellsReady':
                this.gpu?.showCells();
                scene!.cells = this.pendingCells;
                this.panel.offer(this.offers());
                this.redraw();
                return;
            case 'cellsLeftOut':
                toast(report.why, 8000);
                return;
            case 'done':
                this.finishLoading();
                return;
            case 'fault':
                this.fault(report.kind, report.message);
        }
    }

    private begin(name: string, origin: Origin, metadata: Metadata, fileBytes: number): void {
        const same = this.scene !== undefined;
        const { depth } = metadata.grid;
        const levelsWanted = this.gpu ? this.gpu.reserve(metadata, this.settings.memory * kMebi) : depth - 1;
        const box = same ? this.scene!.box : undefined;
        this.scene = { name, origin, metadata, fileBytes, loadedBytes: 0, loadedLevels: 0, levelsWanted, box, cells: undefined, done: false };
        byId('scene-size').textContent = `${2 ** depth}³`;
        if (!same) {
            const light = storedLight(metadata);
            // Smoothing takes a GPU; without one faces are quick, and the control is there.
            const smooth = kDefaults.smooth && !this.gpu?.software;
            const stored = metadata.storedLight !== undefined;
            this.base = { ...kDefaults, ...storedSun(metadata, light, this.axes), light, smooth, stored, finestLevel: depth };
            const link = readLink(location.hash);
            this.settings = { ...this.base, ...link.settings, memory: this.settings.memory };
            this.camera = link.camera;
            this.cameraIsOurs = !link.camera;
            if (!link.camera && metadata.words === 0) this.learnBounds(undefined);
        }
        const drawnElsewhere = this.config?.render;
        if (drawnElsewhere) {
            this.scene.box = drawnElsewhere;
            if (this.cameraIsOurs) this.placeCamera();
        }
        this.panel.show(this.settings);
        this.panel.offer(this.offers());
        if (drawnElsewhere && this.cameraIsOurs && metadata.cameras.length > 0) this.panel.showCamera(0);
        if (this.gpu && metadata.words > 0 && levelsWanted === 0) {
            this.fault('limit', `Not even the first level of the scene fits in ${rounded(this.settings.memory)} MB.`);
        }
    }

    private learnBounds(cells: CellBox | undefined): void {
        const scene = this.scene!;
        const { grid } = scene.metadata;
        const side = 2 ** grid.depth;
        const { low, high } = cells ?? { low: [0, 0, 0] as Vec3, high: [side, side, side] as Vec3 };
        const world = (v: Vec3): Vec3 => add(grid.origin, scale(grid.voxelSize, v));
        scene.box = { low: world(low), high: world(high) };
        if (this.cameraIsOurs) this.placeCamera();
        this.panel.offer(this.offers());
        this.redraw();
    }

    /** Where a scene is first seen from, and the sun with it: as octavo render has them. */
    private placeCamera(): void {
        const { metadata, box } = this.scene!;
        const stored = metadata.cameras[0];
        this.camera = stored ? fromStored(stored, this.axes, box!) : defaultCamera(box!, this.axes, this.frame);
        if (stored) this.panel.showCamera(0);
        const link = readLink(location.hash).settings;
        if (link.sunAzimuth === undefined && this.settings.light === kViewersSun) {
            const behind = this.camera.azimuth + Math.PI;
            const azimuth = Math.round((behind * 180) / Math.PI - 55);
            this.settings = { ...this.settings, sunAzimuth: ((azimuth + 540) % 360) - 180 };
            this.panel.show(this.settings);
        }
    }

    private finishLoading(): void {
        const scene = this.scene!;
        scene.done = true;
        scene.loadedBytes = scene.fileBytes;
        hideLoading();
        const { depth } = scene.metadata.grid;
        if (scene.metadata.words > 0 && scene.levelsWanted < depth - 1 && scene.levelsWanted > 0) {
            const shown = 2 ** openLevel(scene);
            toast(`Shown at ${shown}³ of ${2 ** depth}³: all of it takes ${megabytes(4 * scene.metadata.words)} of GPU memory`, 8000);
        }
        if (scene.metadata.words === 0) toast('The scene has no voxels', 8000);
        this.redraw();
    }

    private fault(kind: FaultKind, message: string): void {
        this.loader?.cancel();
        faultNotice(kind, message, this.scene !== undefined && this.scene.loadedLevels > 0);
    }

    private startGpuPainter(): void {
        this.painter = this.gpu = GpuPainter.make(this.canvas, {
            drawn: () => this.showStatistics(),
            lost: () => {
                this.loader?.cancel();
                this.canvas.dataset.state = 'drawing';
                toast('The GPU was reset; the scene is loaded again', 5000);
            },
            restored: () => {
                if (this.opened) this.load();
            },
            refused: (why) => {
                this.loader?.cancel();
                notice('This GPU cannot draw the scene', why, 'Update the browser or the graphics driver, or run octavo view --render-here.');
            },
        });
    }

    private sayNoWebGl(): void {
        notice(
            'This browser has no WebGL 2',
            'The viewer draws with WebGL 2, which this browser lacks or has turned off.',
            'Update the browser or its graphics driver, turn hardware acceleration on, or run octavo view --render-here.',
        );
    }

    private startRemotePainter(render: NonNullable<Config['render']>): void {
        const here = (path: string): string => new URL(path, location.href).href;
        const image = byId<HTMLImageElement>('remote');
        image.hidden = false;
        byId('open-file').hidden = true;
        const fault = (message: string): void => this.fault('unreachable', message);
        this.painter = new RemotePainter(image, this.canvas, here(render.url), here(render.pick), () => this.showStatistics(), fault);
    }

    /** What is to be seen, when that is known. */
    private get view(): View | undefined {
        const { scene, camera, settings, axes } = this;
        return scene?.box && camera ? { scene, camera, settings, axes } : undefined;
    }

    private redraw(): void {
        const { view } = this;
        this.canvas.dataset.state = 'drawing';
        if (view) this.painter?.show(view);
    }

    private resize(): void {
        const ratio = Math.min(devicePixelRatio || 1, 2);
        const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
        const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
        if (this.canvas.width === width && this.canvas.height === height) return;
        this.canvas.width = width;
        this.canvas.height = height;
        if (this.scene?.box && this.cameraIsOurs) this.placeCamera();
        this.redraw();
        this.painter?.fill();
    }

    private get axes(): Axes {
        return axesOf(this.settings.up);
    }
    private get frame(): Frame {
        const aspect = this.canvas.width / this.canvas.height;
        return { aspect, clear: this.panel.clearOf(this.canvas.getBoundingClientRect()) };
    }
    private get sceneSize(): number {
        return this.scene?.box ? diagonalOf(this.scene.box) : 1;
    }

    private moveTo(camera: Camera): void {
        if (!camera.eye.every((value) => Math.abs(value) < 1e12)) return;
        this.camera = camera;
        this.cameraIsOurs = false;
        this.panel.showFreeCamera();
        this.redraw();
        this.address.follow();
    }

    private frameAll(): void {
        const box = this.scene?.box;
        if (!box || !this.camera) return;
        const towardsEye = scale(-1, forwardOf(this.camera, this.axes));
        this.moveTo(framing(box, this.axes, this.frame, towardsEye, this.camera.verticalFov));
    }

    private chooseCamera(index: number): void {
        const stored = this.scene?.metadata.cameras[index];
        if (!stored || !this.scene?.box) return;
        this.moveTo(fromStored(stored, this.axes, this.scene.box));
        this.panel.showCamera(index);
    }

    private changeSettings(settings: Settings): void {
        const before = this.settings;
        const turned = (['sunAzimuth', 'sunElevation', 'sunSize'] as const).some((key) => before[key] !== settings[key]);
        // A sun of the file that is turned is the viewer's own from there on.
        if (turned && settings.light !== kViewersSun) {
            settings = { ...settings, light: kViewersSun };
            this.panel.show(settings);
        }
        this.settings = settings;
        if (before.up !== settings.up && this.scene?.box) {
            this.camera = defaultCamera(this.scene.box, this.axes, this.frame);
            this.cameraIsOurs = false;
        }
        if (before.memory !== settings.memory && this.opened) {
            this.loader?.cancel();
            this.load();
        }
        if (before.light !== settings.light) this.panel.offer(this.offers());
        const { view } = this;
        if (view && onlyLook(before, settings)) {
            this.painter?.showAgain(view);
            this.showStatistics();
        } else {
            this.redraw();
        }
        this.address.follow();
    }

    private offers(): Offers {
        const metadata = this.scene?.metadata;
        const usable = metadata ? usableLights(metadata) : [];
        const chosen = usable.includes(this.settings.light) ? metadata!.lights[this.settings.light] : undefined;
        return {
            modes: this.config?.render ? ['shaded'] : kModes.filter((mode) => mode !== 'color' || this.scene?.cells !== undefined),
            cameras: metadata?.cameras.map((camera, i) => camera.name || `Camera ${i + 1}`) ?? [],
            lights: usable.map((number) => ({ number, name: metadata!.lights[number]!.name || `Light ${number + 1}` })),
            depth: metadata?.grid.depth ?? 17,
            sceneDiagonal: this.scene?.box ? diagonalOf(this.scene.box) : 0,
            storedLight: this.scene !== undefined && (this.gpu ? hasStoredLight(this.scene) : metadata!.storedLight !== undefined),
            sunLight: this.settings.light !== kAllLights && (!chosen || chosen.kind === 'sun'),
            gpu: this.gpu !== undefined,
        };
    }

    /** @param x  CSS pixels, as `y` */
    private async pick(x: number, y: number): Promise<FoundCell | undefined> {
        const toPixels = this.canvas.width / this.canvas.clientWidth;
        return this.view && this.painter?.pick(this.view, x * toPixels, y * toPixels);
    }

    private async showVoxel(x: number, y: number): Promise<void> {
        const found = await this.pick(x, y);
        byId('voxel').hidden = !found;
        if (!found) return;
        const facts = voxelFacts(found, this.scene!.metadata.grid, this.camera!.eye);
        fillFacts(byId('voxel-facts'), facts);
        byId('voxel').scrollIntoView({ block: 'nearest' });
        // The panel may be closed, as it is on a phone.
        if (byId('panel').classList.contains('closed')) toast(shortFacts(facts), 5000);
    }

    private async focusOn(x: number, y: number): Promise<void> {
        const found = await this.pick(x, y);
        if (!found || !this.camera) return;
        // The view direction stays; the eye moves aside until the voxel is in the middle.
        const forward = forwardOf(this.camera, this.axes);
        const centre = centreOf(found, this.scene!.metadata.grid);
        const distance = length(sub(centre, this.camera.eye));
        this.moveTo({ ...this.camera, distance, eye: sub(centre, scale(distance, forward)) });
        await this.showVoxel(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2);
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
        this.panel.offer(this.offers());
        if (before.memory !== this.settings.memory && this.opened) {
            this.loader?.cancel();
            this.load();
        }
        this.redraw();
    }

    private async savePicture(): Promise<void> {
        const blob = await this.painter?.picture();
        if (!blob) return toast('The picture could not be made');
        const name = `${(this.scene?.name ?? 'octavo').replace(/\.octv$/, '')}.png`;
        download(blob, name);
        toast(`Saved ${name}`);
    }

    private chooseMode(index: number): boolean {
        const mode = this.offers().modes[index];
        if (!mode) return false;
        this.panel.show({ ...this.settings, mode });
        this.changeSettings({ ...this.settings, mode });
        return true;
    }

    private showProgress(): void {
        const { scene } = this;
        if (!scene || scene.done) return;
        const all = scene.fileBytes;
        const levels = scene.metadata.grid.depth - 1;
        showLoading(
            `${megabytes(scene.loadedBytes)} of ${megabytes(all)}`,
            scene.loadedBytes / all,
            `level ${scene.loadedLevels} of ${Math.min(levels, scene.levelsWanted)}`,
        );
    }

    private showStatistics(): void {
        const { painter, scene } = this;
        if (!painter || !scene) return;
        const finished = painter.finished && (scene.done || !this.gpu);
        this.canvas.dataset.state = finished ? 'finished' : 'drawing';
        const now = performance.now();
        if (this.gpu && now - this.shownStatistics < 250 && !finished) return;
        this.shownStatistics = now;
        this.canvas.dataset.samples = String(painter.samples);
        fillFacts(byId('statistics'), [...painter.facts(), ...sceneFacts(scene)]);
    }
}

/** Nothing that rays depend on has changed. */
function onlyLook(before: Settings, after: Settings): boolean {
    return before.mode === after.mode && JSON.stringify({ ...before, exposure: 0 }) === JSON.stringify({ ...after, exposure: 0 });
}
