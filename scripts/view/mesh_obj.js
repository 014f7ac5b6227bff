// mesh_obj.js - Wavefront OBJ: 'v' and 'f', whatever else is in it.
import { Polygons } from 'view/mesh_polygons';
import { Words } from 'view/mesh_words';

const [V, F] = [...'vf'].map((letter) => letter.charCodeAt(0));

// x y z, perhaps with a weight, by which they are divided, or with a colour.
function readVertex(words, polygons) {
    const [x, y, z] = [words.numberInLine(), words.numberInLine(), words.numberInLine()];
    if (!words.more()) {
        polygons.addVertex(x, y, z);
        return;
    }
    const weight = words.number();
    if (words.more()) polygons.addVertex(x, y, z);
    else polygons.addVertex(x / weight, y / weight, z / weight);
}

// Corners such as 3, 3/1/2 or 3//2; counted from 1, or from the last vertex back.
function readFace(words, polygons) {
    while (words.more()) {
        const number = words.number();
        words.skip();
        if (number === 0) throw words.wrong('a face names vertex 0, and OBJ counts from 1');
        polygons.addCorner(number > 0 ? number - 1 : polygons.vertices + number);
    }
    polygons.endPolygon();
}

export function readObj(bytes) {
    const words = new Words(bytes);
    const polygons = new Polygons();
    do {
        if (!words.more() || bytes[words.at + 1] > 32) continue;
        const what = bytes[words.at++];
        if (what === V) readVertex(words, polygons);
        if (what === F) readFace(words, polygons);
    } while (words.nextLine());
    return polygons.finish();
}
