// SPDX-License-Identifier: MIT
//
// How large the pictures are, by what the last ones took. While something moves: as large as can be
// drawn 30 times a second. At rest: larger ones up to the full one, each in strips.

export const kFrame = 33; // milliseconds: 30 frames a second
export const kLeastScale = 0.125; // of the full picture's sides
/** A picture that takes less than this part of a frame may grow; the gap to a whole one keeps it still between. */
const kIdle = 0.6;
/** What it is fitted to: inside the gap from either side, so that the next picture is in it and stays. */
const kFitDown = 0.9;
const kFitUp = 0.8;
/** The most that one picture may change the next, along a side: one that was late by chance does little. */
const kShrink = 0.5;
const kGrow = 1.5;

/**
 * The scale of the next picture while something moves.
 *
 * @param scale  of the last picture, along a side: 0 to 1
 * @param took   milliseconds, in proportion to its pixels
 */
export function liveScaleAfter(scale: number, took: number): number {
    const fitted = (part: number): number => Math.sqrt((part * kFrame) / took);
    let factor = 1;
    if (took > kFrame) factor = Math.max(kShrink, fitted(kFitDown));
    else if (took < kIdle * kFrame) factor = Math.min(kGrow, fitted(kFitUp));
    return Math.max(kLeastScale, Math.min(1, scale * factor));
}

/** Where a GPU is slow the full picture takes long: these parts of it come before, of one sample each. */
const kSteps = [0.25, 0.5];

/**
 * The scales of the pictures at rest, in order; the last is the full one.
 *
 * @param shown  scale of the picture that is there already, 0 for none: it is not drawn again
 * @param full   scale that is asked for
 */
export function restScales(shown: number, full: number): number[] {
    return [...kSteps.map((part) => part * full).filter((scale) => scale > 1.2 * shown), full];
}

const kStrip = 24; // milliseconds, of a picture at rest: between two of them the page answers
/** Pixels of a strip: where the way to the GPU is slow and varies, smaller ones would take for ever. */
export const kLeastStrip = 4096;

/** Pixels of the next strip, by those of the last and what they took. */
export function stripAfter(pixels: number, took: number): number {
    return Math.max(kLeastStrip, pixels * Math.max(0.25, Math.min(2, kStrip / took)));
}
