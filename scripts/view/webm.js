// webm.js - writes encoded frames as a WebM file, which is EBML: elements of an id, a length, content.
const TICK = 1000000; // nanoseconds in a unit of the file's times: it counts milliseconds

const text = (words) => new TextEncoder().encode(words);

// A whole number of as many bytes as asked for.
function whole(value, bytes = 4) {
    return Uint8Array.from({ length: bytes }, (_, i) => Math.floor(value / 256 ** (bytes - 1 - i)) % 256);
}

function real(value) {
    const bytes = new Uint8Array(8);
    new DataView(bytes.buffer).setFloat64(0, value);
    return bytes;
}

// An element as parts for a Blob: `id` in hexadecimal digits, content of bytes and other elements.
function element(id, ...content) {
    const parts = content.flat();
    const length = parts.reduce((sum, part) => sum + part.length, 0);
    const name = Uint8Array.from(id.match(/../g), (digits) => parseInt(digits, 16));
    return [name, Uint8Array.of(1, ...whole(length, 7)), ...parts];
}

// A frame in a cluster that begins at `start`: track 1, its time from there, and whether it stands alone.
function block({ time, key, bytes }, start) {
    return element('a3', Uint8Array.of(0x81, ...whole(time - start, 2), key ? 0x80 : 0), bytes);
}

// Frames from one that stands alone up to the next such.
function clusters(frames) {
    const groups = [];
    for (const frame of frames) {
        if (frame.key) groups.push([]);
        groups.at(-1).push(frame);
    }
    return groups.map((group) => element('1f43b675', element('e7', whole(group[0].time)),
        ...group.map((frame) => block(frame, group[0].time))));
}

// The file. Frames are { time, key, bytes }, times in whole milliseconds; the first stands alone.
export function makeWebm(frames, { codec, width, height, duration }) {
    const head = element('1a45dfa3', element('4282', text('webm')), element('4287', whole(2)),
        element('4285', whole(2)));
    const info = element('1549a966', element('2ad7b1', whole(TICK)), element('4489', real(duration)),
        element('4d80', text('shapebench')), element('5741', text('shapebench')));
    const video = element('e0', element('b0', whole(width)), element('ba', whole(height)));
    const track = element('ae', element('d7', whole(1)), element('73c5', whole(1)), element('83', whole(1)),
        element('86', text(codec)), video);
    const segment = element('18538067', info, element('1654ae6b', track), ...clusters(frames));
    return new Blob([...head, ...segment], { type: 'video/webm' });
}
