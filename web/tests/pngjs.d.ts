declare module 'pngjs' {
    export class PNG {
        static sync: { read(bytes: Uint8Array): PNG; write(picture: PNG): Buffer };
        width: number;
        height: number;
        data: Buffer;
    }
}
