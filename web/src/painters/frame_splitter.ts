// SPDX-License-Identifier: MIT

/** Takes the frames out of an answer: each comes behind its length in four bytes. */
export class FrameSplitter {
    private bytes = new Uint8Array(0);

    add(piece: Uint8Array): Uint8Array<ArrayBuffer>[] {
        const joined = new Uint8Array(this.bytes.length + piece.length);
        joined.set(this.bytes);
        joined.set(piece, this.bytes.length);
        this.bytes = joined;
        const frames: Uint8Array<ArrayBuffer>[] = [];
        while (this.bytes.length >= 4) {
            const view = new DataView(this.bytes.buffer, this.bytes.byteOffset);
            const end = 4 + view.getUint32(0, true);
            if (this.bytes.length < end) break;
            frames.push(this.bytes.slice(4, end));
            this.bytes = this.bytes.slice(end);
        }
        return frames;
    }
}
