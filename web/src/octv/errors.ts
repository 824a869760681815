// SPDX-License-Identifier: MIT

export type FaultKind =
    | 'damaged' // the bytes are not what they should be
    | 'unsupported' // a newer program wrote it
    | 'unreachable' // the bytes do not come
    | 'limit'; // this machine cannot hold it

/** Why a file cannot be shown, in words for the person who opened it. */
export class FileFault extends Error {
    constructor(
        readonly kind: FaultKind,
        message: string,
    ) {
        super(message);
        this.name = 'FileFault';
    }
}

export function damaged(message: string): FileFault {
    return new FileFault('damaged', message);
}
