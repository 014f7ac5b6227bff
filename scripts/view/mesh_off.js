// mesh_off.js - Geomview's OFF, with colours and normals or without, as text.
import { Polygons } from 'view/mesh_polygons';
import { Words } from 'view/mesh_words';

// Past the keyword, which tells what a vertex's numbers are; the first three are its place.
function readKeyword(words) {
    const keyword = words.findData() ? words.word() : '';
    if (!/^\w*OFF$/.test(keyword)) throw new Error("does not begin with 'OFF'; export it again");
    if (/[n4]/.test(keyword)) throw new Error(`'${keyword}' is not of three dimensions; export it as OFF`);
    if (words.more() && words.bytes[words.at] === 66) throw new Error('is binary OFF; export it as text');
}

// Each vertex and each face has a line.
function nextData(words) {
    words.nextLine();
    if (!words.findData()) throw words.wrong('it ends before the last of its faces');
}

export function readOff(bytes) {
    const words = new Words(bytes);
    const polygons = new Polygons();
    readKeyword(words);
    if (!words.findData()) throw words.wrong('the counts of vertices and faces are missing');
    const [vertices, faces] = [words.numberInLine(), words.numberInLine()];
    for (let v = 0; v < vertices; v++) {
        nextData(words);
        polygons.addVertex(words.number(), words.numberInLine(), words.numberInLine());
    }
    for (let f = 0; f < faces; f++) {
        nextData(words);
        const corners = words.number();
        for (let c = 0; c < corners; c++) polygons.addCorner(words.numberInLine());
        polygons.endPolygon();
    }
    return polygons.finish();
}
