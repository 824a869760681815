// SPDX-License-Identifier: MIT

const kDigits = 3;

/** 1234567 → "1.23 M" */
export function shortCount(value: number): string {
    const units = ['', ' k', ' M', ' G', ' T'];
    let unit = 0;
    let left = value;
    while (left >= 999.5 && unit < units.length - 1) {
        left /= 1000;
        unit += 1;
    }
    return unit === 0 ? String(Math.round(left)) : `${left.toPrecision(kDigits)}${units[unit]}`;
}

export function megabytes(bytes: number): string {
    const mb = bytes / 1e6;
    return mb >= 1000 ? `${(mb / 1000).toPrecision(kDigits)} GB` : `${mb >= 100 ? Math.round(mb) : mb.toPrecision(2)} MB`;
}

/** World units, with as many digits as tell a voxel from the next. */
export function worldNumber(value: number, voxelSize: number): string {
    const digits = Math.max(0, Math.min(12, Math.ceil(-Math.log10(voxelSize)) + 1));
    return value.toFixed(digits);
}

export function rounded(value: number, digits = kDigits): string {
    return String(Number(value.toPrecision(digits)));
}

/** A colour in linear light as a screen's: "#c8873a". */
export function srgbText(linear: readonly number[]): string {
    const channel = (x: number): string => {
        const c = Math.max(0, Math.min(1, x));
        const s = c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
        return Math.round(255 * s).toString(16).padStart(2, '0');
    };
    return `#${linear.map(channel).join('')}`;
}
