// SPDX-License-Identifier: MIT
//
// A file on its way into the page: what the reader tells goes to the GPU, to the scene, and to the
// bar that shows how much has come.
import type { CellBox } from '../octv/content_bounds';
import type { FaultKind } from '../octv/errors';
import type { FileFacts } from '../octv/reader';
import type { Origin, Report } from '../octv/worker';
import type { GpuPainter } from '../painters/gpu_painter';
import { byId } from '../ui/dom';
import { faultNotice, hideLoading, hideNotice, showLoading, toast } from '../ui/messages';
import { megabytes, rounded } from '../ui/numbers';
import type { Box } from '../view/camera';
import { type Vec3, add, scale } from '../view/vec';
import { type Scene, openLevel } from './scene';
import { SceneLoader } from './scene_loader';

const kMebi = 1024 * 1024;
const kLong = 8000; // milliseconds that a line with a reason stays

export interface OpeningEvents {
    /** A file is read: what is shown is not what was asked for any more. */
    reading(): void;
    /** What the file is, is known. @param again  it was there before, and is read once more */
    began(scene: Scene, again: boolean): void;
    /** Where its voxels are, is known, or better than before. */
    bounded(): void;
    /** More of it can be shown. */
    grew(): void;
}

export class Opening {
    scene: Scene | undefined;
    private loader: SceneLoader | undefined;
    private opened: { name: string; origin: Origin } | undefined;
    private memory = 0;

    /**
     * @param gpu       what the scene is for; none where another machine draws, and has it
     * @param knownBox  of the voxels, where that machine has said so
     */
    constructor(
        private readonly gpu: GpuPainter | undefined,
        private readonly knownBox: Box | undefined,
        private readonly events: OpeningEvents,
    ) {}

    /** @param memory  MiB that it may take on the GPU */
    open(name: string, origin: Origin, memory: number): void {
        this.loader?.cancel();
        this.opened = { name, origin };
        this.scene = undefined;
        hideNotice();
        byId('voxel').hidden = true;
        document.title = `${name} · Octavo`;
        byId('scene-name').textContent = name;
        showLoading('Opening', 0, '');
        this.read(memory);
    }

    /** Once more, as the GPU has forgotten it or may take more or less of it. */
    readAgain(memory: number): void {
        this.loader?.cancel();
        if (this.opened) this.read(memory);
    }

    stop(): void {
        this.loader?.cancel();
    }

    fault(kind: FaultKind, message: string): void {
        this.loader?.cancel();
        faultNotice(kind, message, this.scene !== undefined && this.scene.loadedLevels > 0);
    }

    private read(memory: number): void {
        this.memory = memory;
        this.events.reading();
        if (this.scene) this.scene.done = false;
        this.gpu?.dropCells();
        this.loader = new SceneLoader(this.opened!.origin, this.gpu ? memory * kMebi : 0, (report) => this.hear(report));
    }

    private hear(report: Report): void {
        const { scene, gpu } = this;
        switch (report.is) {
            case 'opened':
                return this.begin(report.facts);
            case 'progress':
                if (scene) scene.loadedBytes = report.bytes;
                return this.showProgress();
            case 'words':
                return gpu?.append(report.words);
            case 'level':
                scene!.loadedLevels = report.level + 1;
                this.showProgress();
                return this.events.grew();
            case 'bounds':
                return this.learnBounds(report.box);
            case 'cells':
                if (gpu?.reserveCells(report.layout)) scene!.cellsToCome = report.layout;
                else toast('This GPU has no room for the colours', kLong);
                return;
            case 'cellWords':
                return gpu?.appendCells(report.words);
            case 'cellsReady':
                gpu?.showCells();
                scene!.cells = scene!.cellsToCome;
                return this.events.grew();
            case 'cellsLeftOut':
                return toast(report.why, kLong);
            case 'done':
                return this.finish();
            case 'fault':
                return this.fault(report.kind, report.message);
        }
    }

    private begin({ metadata, fileBytes }: FileFacts): void {
        const before = this.scene;
        const { depth } = metadata.grid;
        const levelsWanted = this.gpu ? this.gpu.reserve(metadata, this.memory * kMebi) : depth - 1;
        this.scene = {
            name: this.opened!.name, metadata, fileBytes, loadedBytes: 0, loadedLevels: 0, levelsWanted,
            box: before?.box, cells: undefined, cellsToCome: undefined, done: false,
        };
        byId('scene-size').textContent = `${2 ** depth}³`;
        this.events.began(this.scene, before !== undefined);
        if (this.knownBox) this.place(this.knownBox);
        else if (metadata.words === 0) this.learnBounds(undefined);
        if (this.gpu && metadata.words > 0 && levelsWanted === 0) {
            this.fault('limit', `Not even the first level of the scene fits in ${rounded(this.memory)} MB.`);
        }
    }

    /** @param cells  where voxels are; none: anywhere in the grid */
    private learnBounds(cells: CellBox | undefined): void {
        const { grid } = this.scene!.metadata;
        const side = 2 ** grid.depth;
        const { low, high } = cells ?? { low: [0, 0, 0] as Vec3, high: [side, side, side] as Vec3 };
        const world = (v: Vec3): Vec3 => add(grid.origin, scale(grid.voxelSize, v));
        this.place({ low: world(low), high: world(high) });
    }

    private place(box: Box): void {
        this.scene!.box = box;
        this.events.bounded();
    }

    private finish(): void {
        const scene = this.scene!;
        scene.done = true;
        scene.loadedBytes = scene.fileBytes;
        hideLoading();
        const { metadata, levelsWanted } = scene;
        const { depth } = metadata.grid;
        if (metadata.words > 0 && levelsWanted < depth - 1 && levelsWanted > 0) {
            const shown = 2 ** openLevel(scene);
            toast(`Shown at ${shown}³ of ${2 ** depth}³: all of it takes ${megabytes(4 * metadata.words)} of GPU memory`, kLong);
        }
        if (metadata.words === 0) toast('The scene has no voxels', kLong);
        this.events.grew();
    }

    private showProgress(): void {
        const { scene } = this;
        if (!scene || scene.done) return;
        const { grid, attributes, storedLight } = scene.metadata;
        const levels = Math.min(grid.depth - 1, scene.levelsWanted);
        const behind = attributes && scene.loadedLevels === grid.depth - 1; // what comes behind the levels
        showLoading(
            `${megabytes(scene.loadedBytes)} of ${megabytes(scene.fileBytes)}`,
            scene.loadedBytes / scene.fileBytes,
            behind ? `colours${storedLight ? ' and light' : ''}` : `level ${scene.loadedLevels} of ${levels}`,
        );
    }
}
