// SPDX-License-Identifier: MIT
//
// The page: who draws, what is opened, where the viewer stands, and which of them tells which.
import { GpuPainter } from '../painters/gpu_painter';
import type { Painter, View } from '../painters/painter';
import { RemotePainter } from '../painters/remote_painter';
import { bindButtons, bindDropping, download, togglePanel } from '../ui/buttons';
import { byId, fillFacts } from '../ui/dom';
import { fromDiskNotice, noSceneNotice, noWebGlNotice, notice, toast } from '../ui/messages';
import { rounded } from '../ui/numbers';
import { startTheme } from '../ui/theme';
import { diagonalOf } from '../view/camera';
import { Controls } from '../view/controls';
import { type Config, readConfig, takeInlineScene } from './config';
import { offersFor } from './offers';
import { Opening } from './opening';
import { type Scene, sceneFacts } from './scene';
import { Stand } from './stand';
import { VoxelReader } from './voxel_reader';

const kNarrow = 720; // CSS pixels: where the panel would hide the picture, it is closed at first
const kStatisticsEvery = 250; // milliseconds

export class App {
    private readonly canvas = byId<HTMLCanvasElement>('picture');
    private readonly config = readConfig();
    private readonly stand: Stand;
    private readonly painter: Painter | undefined;
    private readonly gpu: GpuPainter | undefined; // the painter, where this machine draws and needs the scene
    private readonly opening: Opening;
    private shownStatistics = 0;

    constructor() {
        startTheme();
        if (innerWidth <= kNarrow) togglePanel(false);
        const { canvas } = this;
        const scene = (): Scene | undefined => this.opening?.scene;
        this.stand = new Stand({
            scene,
            canvas,
            offers: (settings) => offersFor(scene(), settings, this.config?.render === undefined),
            changed: () => this.redraw(),
            recoloured: () => this.recolour(),
            memoryChanged: () => this.opening.readAgain(this.stand.settings.memory),
        });
        const { stand } = this;
        this.fitCanvas();
        if (this.config?.render) this.painter = this.makeRemotePainter(this.config.render);
        else this.painter = this.gpu = this.makeGpuPainter();
        this.opening = new Opening(this.gpu, this.config?.render, {
            reading: () => this.expect(),
            began: (begun, again) => {
                if (again) stand.offer();
                else stand.begin(begun, !this.gpu?.software);
            },
            bounded: () => {
                stand.place();
                stand.offer();
                this.redraw();
            },
            grew: () => {
                stand.offer();
                this.redraw();
            },
        });
        const voxels = new VoxelReader({ canvas, view: () => this.view, painter: () => this.painter, moveTo: (camera) => stand.moveTo(camera) });
        new Controls(canvas, {
            camera: () => stand.camera,
            axes: () => stand.axes,
            sceneSize: () => (scene()?.box ? diagonalOf(scene()!.box!) : 1),
            voxelSize: () => scene()?.metadata.grid.voxelSize ?? 1,
            moveTo: (camera) => stand.moveTo(camera),
            click: (x, y) => void voxels.read(x, y),
            doubleClick: (x, y) => void voxels.focus(x, y),
            readMiddle: () => voxels.readMiddle(),
            focusMiddle: () => voxels.focusMiddle(),
            speedChanged: (speed) => toast(`Speed ${rounded(speed)} units a second`),
        });
        const open = (name: string, blob: Blob): void => {
            if (this.painter) this.opening.open(name, { blob }, stand.settings.memory);
            else noWebGlNotice();
        };
        bindButtons({
            frameAll: () => stand.frameAll(),
            savePicture: () => void this.savePicture(),
            copyLink: () => void stand.address.copy(),
            open,
            chooseMode: (index) => stand.chooseMode(index),
        });
        if (!this.config?.render) bindDropping(open); // another machine has its own file
        new ResizeObserver(() => this.resize()).observe(canvas);
        stand.offer();
        this.openConfigured();
    }

    private openConfigured(): void {
        const { config } = this;
        const { memory } = this.stand.settings;
        if (!this.painter) noWebGlNotice();
        else if (!config) noSceneNotice();
        else if (config.inline) this.opening.open(config.name, { bytes: takeInlineScene() }, memory);
        else if (location.protocol === 'file:') fromDiskNotice();
        else this.opening.open(config.name, { url: new URL(config.url!, location.href).href }, memory);
    }

    private makeGpuPainter(): GpuPainter | undefined {
        return GpuPainter.make(this.canvas, {
            drawn: () => this.showStatistics(),
            lost: () => {
                this.opening.stop();
                this.expect();
                toast('The GPU was reset; the scene is loaded again', 5000);
            },
            restored: () => this.opening.readAgain(this.stand.settings.memory),
            refused: (why) => {
                this.opening.stop();
                notice('This GPU cannot draw the scene', why, 'Update the browser or the graphics driver, or run octavo view --render-here.');
            },
        });
    }

    private makeRemotePainter(render: NonNullable<Config['render']>): RemotePainter {
        const here = (path: string): string => new URL(path, location.href).href;
        const image = byId<HTMLImageElement>('remote');
        image.hidden = false;
        byId('open-file').hidden = true;
        const fault = (message: string): void => this.opening.fault('unreachable', message);
        return new RemotePainter(image, this.canvas, here(render.url), here(render.pick), () => this.showStatistics(), fault);
    }

    /** What is to be seen, when that is known. */
    private get view(): View | undefined {
        const { scene } = this.opening;
        const { camera, settings, axes } = this.stand;
        return scene?.box && camera ? { scene, camera, settings, axes } : undefined;
    }

    private redraw(): void {
        const { view } = this;
        this.expect();
        if (view) this.painter?.show(view);
    }

    /** The picture is not what was asked for, until showStatistics() finds that it is. */
    private expect(): void {
        this.canvas.dataset.state = 'drawing';
    }

    private recolour(): void {
        const { view } = this;
        if (view) this.painter?.showAgain(view);
        this.showStatistics();
    }

    private resize(): void {
        if (!this.fitCanvas()) return;
        this.stand.place();
        this.redraw();
        this.painter?.fill();
    }

    /** @returns whether the canvas has other pixels than before */
    private fitCanvas(): boolean {
        const { canvas } = this;
        const ratio = Math.min(devicePixelRatio || 1, 2);
        const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
        const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
        if (canvas.width === width && canvas.height === height) return false;
        canvas.width = width;
        canvas.height = height;
        return true;
    }

    private async savePicture(): Promise<void> {
        const blob = await this.painter?.picture();
        if (!blob) return toast('The picture could not be made');
        const name = `${(this.opening.scene?.name ?? 'octavo').replace(/\.octv$/, '')}.png`;
        download(blob, name);
        toast(`Saved ${name}`);
    }

    private showStatistics(): void {
        const { painter } = this;
        const { scene } = this.opening;
        if (!painter || !scene) return;
        const finished = painter.finished && (scene.done || !this.gpu);
        this.canvas.dataset.state = finished ? 'finished' : 'drawing';
        const now = performance.now();
        if (this.gpu && now - this.shownStatistics < kStatisticsEvery && !finished) return;
        this.shownStatistics = now;
        this.canvas.dataset.samples = String(painter.samples);
        fillFacts(byId('statistics'), [...painter.facts(), ...sceneFacts(scene)]);
    }
}
