// share.js - takes a scene out of the page and into it: as a link, a file, a picture.

async function pipe(bytes, stream) {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

export function fromBase64(text) {
    const usual = text.replaceAll('-', '+').replaceAll('_', '/').trim();
    return Uint8Array.from(atob(usual), (letter) => letter.charCodeAt(0));
}

export const unzip = (bytes, how) => pipe(bytes, new DecompressionStream(how));

// The part after '#' that carries a scene's text.
export async function packScene(text) {
    const bytes = await pipe(new TextEncoder().encode(text), new CompressionStream('deflate'));
    const base64 = btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
    return `scene=${base64.replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
}

// The scene's text of that part; undefined where there is none, or none that can be read.
export async function unpackScene(fragment) {
    const packed = /(?:^#?|&)scene=([\w-]+)/.exec(fragment)?.[1];
    try {
        return packed && new TextDecoder().decode(await unzip(fromBase64(packed), 'deflate'));
    } catch {
        return undefined;
    }
}

export function saveFile(name, blob) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// Copies the canvas as it has just been drawn onto another, of whose size it gets, with a line on each view.
export function copyWithCaptions(copy, canvas, boxes, captions, ink) {
    const pen = copy.getContext('2d', { alpha: false });
    pen.setTransform(copy.width / canvas.width, 0, 0, copy.height / canvas.height, 0, 0);
    pen.drawImage(canvas, 0, 0);
    pen.fillStyle = ink;
    const size = Math.round(Math.max(...boxes.map((box) => box.height)) / 28);
    pen.font = `${size}px sans-serif`;
    boxes.forEach((box, side) => {
        pen.fillText(captions[side], box.x + size, canvas.height - box.y - box.height + 1.8 * size);
    });
}
