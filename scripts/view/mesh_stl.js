// mesh_stl.js - STL, binary and text: triangles, each with its own three corners.
import { Polygons } from 'view/mesh_polygons';
import { Words } from 'view/mesh_words';

const [HEADER, FACET] = [84, 50]; // bytes
const NORMAL = 12; // before a facet's corners

const isText = (bytes) => /^\s*solid[^\0]*$/i.test(String.fromCharCode(...bytes.subarray(0, 200)));

function readBinary(view, facets) {
    const polygons = new Polygons();
    for (let f = 0; f < facets; f++) {
        for (let c = 0; c < 3; c++) {
            const at = HEADER + f * FACET + NORMAL + 12 * c;
            polygons.addCorner(polygons.vertices);
            polygons.addVertex(...[0, 4, 8].map((by) => view.getFloat32(at + by, true)));
        }
        polygons.endPolygon();
    }
    return polygons.finish();
}

function readText(bytes) {
    const words = new Words(bytes);
    const polygons = new Polygons();
    let open = false; // a facet
    words.nextLine(); // the name may be any words
    while (words.find()) {
        const word = words.word().toLowerCase();
        if (word === 'facet') open = true;
        if (word === 'solid') words.nextLine();
        if (word === 'vertex') {
            polygons.addCorner(polygons.vertices);
            polygons.addVertex(words.numberInLine(), words.numberInLine(), words.numberInLine());
        }
        if (word !== 'endfacet') continue;
        polygons.endPolygon();
        open = false;
    }
    if (open) throw words.wrong('it ends within a facet');
    return polygons.finish();
}

// A binary file may begin with "solid" as well: then its length tells it.
export function readStl(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const facets = bytes.length >= HEADER ? view.getUint32(80, true) : 0;
    const length = HEADER + FACET * facets;
    if (bytes.length === length) return readBinary(view, facets);
    if (isText(bytes)) return readText(bytes);
    if (bytes.length < HEADER) throw new Error(`is no STL: it is shorter than ${HEADER} bytes`);
    throw new Error(`says that it has ${facets} facets, which take ${length} bytes, and has ${bytes.length}; `
        + 'is it damaged or cut off? Export it again');
}
