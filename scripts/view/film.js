// film.js - keeps the last ten seconds of the views as they are seen, encoded, and saves them as a video.
// MediaRecorder could not: what it has recorded cannot be cut at its beginning.
import { saveFile } from 'view/share';
import { makeWebm } from 'view/webm';

const SECONDS = 10;
const RATE = 30; // pictures a second, at most
const WIDEST = 1280; // pixels
const GAP_MS = 500; // longer pauses are cut down to it
const KEY_MS = 1000; // between two frames that stand alone, where the film can be cut
const QUEUED = 2; // frames that wait for the encoder: then it takes no more
const BITRATE = 5e6;
const CODECS = [['vp8', 'V_VP8'], ['vp09.00.31.08', 'V_VP9']]; // their names here, and in WebM

// The first codec that the browser encodes, or why there is none.
async function findCodec() {
    if (!window.VideoEncoder)
        throw new Error('This browser cannot encode video, or only for pages from files and by https.');
    for (const [codec, name] of CODECS) {
        const asked = { codec, width: WIDEST, height: WIDEST / 2, bitrate: BITRATE, framerate: RATE };
        if ((await VideoEncoder.isConfigSupported(asked)).supported) return { codec, name };
    }
    throw new Error('This browser encodes no video for WebM (VP8 or VP9).');
}

export class Film {
    // The button is disabled, and says why, where there can be no video.
    constructor(button) {
        this.button = button;
        this.copy = document.createElement('canvas');
        Object.assign(this, { last: -Infinity, time: 0 });
        this.restart();
        findCodec().then((codec) => { this.codec = codec; }).catch((error) => this.stop(error));
    }

    stop(error) {
        this.codec = null;
        this.button.disabled = true;
        this.button.title = error.message;
    }

    // Forgets all frames; the next has another size.
    restart() {
        if (this.encoder?.state === 'configured') this.encoder.close();
        Object.assign(this, { encoder: null, frames: [], key: -Infinity });
    }

    configure(width, height) {
        this.restart();
        Object.assign(this.copy, { width, height });
        const encoder = new VideoEncoder({
            output: (chunk) => encoder === this.encoder && this.keep(chunk),
            error: (error) => encoder === this.encoder && this.stop(error),
        });
        encoder.configure({ codec: this.codec.codec, width, height, bitrate: BITRATE, framerate: RATE,
            latencyMode: 'realtime' });
        this.encoder = encoder;
    }

    // Keeps a frame, and drops what is older than ten seconds up to one that stands alone.
    keep(chunk) {
        const bytes = new Uint8Array(chunk.byteLength);
        chunk.copyTo(bytes);
        this.frames.push({ time: Math.round(chunk.timestamp / 1000), key: chunk.type === 'key', bytes });
        const begin = this.frames.at(-1).time - 1000 * SECONDS;
        const next = this.frames.findLastIndex(({ key, time }) => key && time <= begin);
        if (next > 0) this.frames.splice(0, next);
    }

    // Takes what has just been drawn on a canvas, which `paint` copies with its captions; not more often
    // than RATE, and not while the encoder is behind.
    add(now, canvas, paint) {
        const since = now - this.last;
        if (!this.codec || since < 1000 / RATE - 4 || this.encoder?.encodeQueueSize >= QUEUED) return;
        const scale = Math.min(1, WIDEST / canvas.width);
        const [width, height] = [canvas.width, canvas.height].map((n) => 2 * Math.floor(scale * n / 2));
        if (!width || !height) return;
        if (!this.encoder || width !== this.copy.width || height !== this.copy.height)
            this.configure(width, height);
        this.last = now;
        this.time += Math.min(since, GAP_MS);
        paint(this.copy);
        this.encode();
    }

    encode() {
        const keyFrame = this.time - this.key >= KEY_MS;
        if (keyFrame) this.key = this.time;
        const frame = new VideoFrame(this.copy, { timestamp: Math.round(1000 * this.time) });
        this.encoder.encode(frame, { keyFrame });
        frame.close();
    }

    // The last ten seconds, and up to one more, as WebM; null while there is nothing.
    async video() {
        await this.encoder?.flush();
        if (!this.frames.length) return null;
        const { width, height } = this.copy;
        const start = this.frames[0].time;
        const frames = this.frames.map((frame) => ({ ...frame, time: frame.time - start }));
        const duration = frames.at(-1).time + 1000 / RATE;
        return makeWebm(frames, { codec: this.codec.name, width, height, duration });
    }

    // Saves it; '' or why not.
    async save() {
        const video = await this.video();
        if (video) saveFile('shapebench.webm', video);
        return video ? '' : 'Nothing has moved yet: there is no video.';
    }
}
