// SPDX-License-Identifier: MIT
//
// Which programs there are, and which of them can be used already. Compiling all takes seconds in some
// browsers, so the small one of the preview comes first, and the others one after the other, as the
// view needs them, each for what the view has: colours, lamps and smoothed normals are left out of
// programs that need none. Nothing here waits: a driver may compile at the first draw as well, so
// that is one of a single pixel, and only when the GPU has done it a program counts as ready.
import { Program } from './program';
import {
    beamText, keepText, keepVertexText, kVertexText, normalText, pickText, presentText, previewText, primaryText, shadeText, storedText, viewsText,
} from './shader_text';

export type Part = 'preview' | 'present' | 'primary' | 'beam' | 'normals' | 'keep' | 'pick';
export type Painting = 'shade' | 'views' | 'stored';

/** What a program that paints hits has, added up. One that has more serves too. */
export const kSmooth = 1; // normals of the cache
export const kCells = 2; // looks of the file's cells
export const kAnyLamp = 4; // else suns only

/** A program by what it does. */
export type Recipe = { part: Part } | { painting: Painting; features: number };

type State = 'compiling' | 'warming' | 'ready';
interface Entry {
    recipe: Recipe;
    program: Program;
    state: State;
}

const nameOf = (recipe: Recipe): string => ('part' in recipe ? recipe.part : `${recipe.painting} ${recipe.features}`);

/** Can the one be used in place of the other? */
function serves(recipe: Recipe, wanted: Recipe): boolean {
    if ('part' in recipe || 'part' in wanted) return nameOf(recipe) === nameOf(wanted);
    return recipe.painting === wanted.painting && (recipe.features & wanted.features) === wanted.features;
}

export class Programs {
    private readonly entries = new Map<string, Entry>();
    private wanted: Recipe[] = [];

    /**
     * @param warm   draws a pixel with a program that has not drawn yet
     * @param first  what nothing can be shown without
     */
    constructor(
        private readonly gl: WebGL2RenderingContext,
        private readonly rowBits: number,
        private readonly parallel: KHR_parallel_shader_compile | null,
        private readonly warm: (program: Program, recipe: Recipe) => void,
        first: Recipe[],
    ) {
        this.begin(first);
    }

    /** What to have next, most urgent first, in place of what was wanted and is not begun. */
    want(recipes: Recipe[]): void {
        this.wanted = recipes.filter((recipe) => ![...this.entries.values()].some((entry) => serves(entry.recipe, recipe)));
    }

    /** @returns undefined until it is ready */
    part(part: Part): Program | undefined {
        const entry = this.entries.get(part);
        return entry?.state === 'ready' ? entry.program : undefined;
    }

    /** The one that has these features, and of several the smallest. @returns undefined until one is ready */
    painter(painting: Painting, features: number): Program | undefined {
        let best: { features: number; program: Program } | undefined;
        for (const { recipe, program, state } of this.entries.values()) {
            if (state !== 'ready' || !('painting' in recipe) || !serves(recipe, { painting, features })) continue;
            if (!best || recipe.features < best.features) best = { features: recipe.features, program };
        }
        return best?.program;
    }

    /** Is there something to do for step()? */
    get busy(): boolean {
        return this.wanted.length > 0 || [...this.entries.values()].some(({ state }) => state !== 'ready');
    }

    /**
     * Takes the programs on by one step. Call it when the GPU has done all that it was given.
     *
     * @returns whether it has given the GPU something to do
     * @throws Error where the GPU's compiler refuses a program
     */
    step(): boolean {
        const all = [...this.entries.values()];
        const warmed = all.filter(({ state }) => state === 'warming');
        for (const entry of warmed) entry.state = 'ready';
        if (warmed.length > 0) return false; // a picture with these first
        const compiling = all.filter(({ state }) => state === 'compiling');
        const next = compiling.filter(({ program }) => program.compiled);
        for (const { program, recipe } of next) {
            program.check();
            this.warm(program, recipe);
        }
        for (const entry of next) entry.state = 'warming';
        // Compilers that work beside the page get all at once; else one at a time, so that frames fit between.
        const count = this.parallel ? this.wanted.length : compiling.length > 0 ? 0 : 1;
        return this.begin(this.wanted.splice(0, count)) || next.length > 0;
    }

    /** @returns whether there was anything to begin */
    private begin(recipes: Recipe[]): boolean {
        for (const recipe of recipes) {
            this.entries.set(nameOf(recipe), { recipe, program: this.compile(recipe), state: 'compiling' });
        }
        return recipes.length > 0;
    }

    private compile(recipe: Recipe): Program {
        const [vertex, fragment] = this.texts(recipe);
        return new Program(this.gl, vertex, fragment, this.parallel);
    }

    private texts(recipe: Recipe): [vertex: string, fragment: string] {
        const { rowBits } = this;
        if ('painting' in recipe) {
            const has = (feature: number): boolean => (recipe.features & feature) !== 0;
            const parts = { smooth: has(kSmooth), cells: has(kCells), anyLamp: has(kAnyLamp) };
            return [kVertexText, { shade: shadeText, views: viewsText, stored: storedText }[recipe.painting](rowBits, parts)];
        }
        if (recipe.part === 'keep') return [keepVertexText(rowBits), keepText()];
        const text = { preview: previewText, present: presentText, primary: primaryText, beam: beamText, normals: normalText, pick: pickText }[recipe.part];
        return [kVertexText, text(rowBits)];
    }
}
