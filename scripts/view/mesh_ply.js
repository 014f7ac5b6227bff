// mesh_ply.js - Stanford PLY: text, or binary of either byte order; elements and properties in any order.
import { Polygons } from 'view/mesh_polygons';
import { Words } from 'view/mesh_words';

// A type's name in a DataView's methods, and its bytes.
const TYPES = {
    char: ['Int8', 1], uchar: ['Uint8', 1], short: ['Int16', 2], ushort: ['Uint16', 2], int: ['Int32', 4],
    uint: ['Uint32', 4], float: ['Float32', 4], double: ['Float64', 8], int8: ['Int8', 1],
    uint8: ['Uint8', 1], int16: ['Int16', 2], uint16: ['Uint16', 2], int32: ['Int32', 4],
    uint32: ['Uint32', 4], float32: ['Float32', 4], float64: ['Float64', 8],
};
const FORMATS = ['ascii', 'binary_little_endian', 'binary_big_endian'];
const LONGEST = 1 << 16; // bytes of a header
const CUT = 'is it damaged or cut off? Export it again';

function typeOf(name) {
    if (!TYPES[name]) throw new Error(`the header's type '${name}' is none of PLY's; ${CUT}`);
    return name;
}

// A line of the header.
function addLine(header, [key, ...rest]) {
    const last = header.elements.at(-1);
    if (key === 'format') [header.format] = rest;
    if (key === 'element') header.elements.push({ name: rest[0], count: Number(rest[1]), properties: [] });
    if (key !== 'property') return;
    if (!last) throw new Error(`the header has a property before any element; ${CUT}`);
    const list = rest[0] === 'list';
    const [type, name] = rest.slice(list ? 2 : 0);
    last.properties.push({ name, type: typeOf(type), length: list ? typeOf(rest[1]) : null });
}

// The elements that the header declares, and where the data begin.
function readHeader(bytes) {
    const text = String.fromCharCode(...bytes.subarray(0, LONGEST));
    const end = /^ply\s[^]*?[\r\n]end_header[ \t]*(\r?\n|\r)/.exec(text);
    if (!end) throw new Error(`has no header from 'ply' to 'end_header'; ${CUT}`);
    const header = { elements: [], data: end[0].length };
    for (const line of end[0].split(/[\r\n]+/)) addLine(header, line.trim().split(/\s+/));
    if (!FORMATS.includes(header.format)) throw new Error(`PLY has no format '${header.format}'; ${CUT}`);
    for (const { name, count } of header.elements)
        if (!(count >= 0)) throw new Error(`the header does not say how many '${name}' there are; ${CUT}`);
    return header;
}

// Numbers one after the other, of text: next(type).
class TextNumbers {
    constructor(bytes, at) { this.words = new Words(bytes, at); }

    next() {
        if (!this.words.find()) throw this.words.wrong('it ends before its last number');
        return this.words.number();
    }

    finished() { return !this.words.find(); }
}

// The same of binary data.
class BinaryNumbers {
    constructor(bytes, at, little) {
        this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
        Object.assign(this, { at, little });
    }

    next(type) {
        const [method, size] = TYPES[type];
        if (this.at + size > this.view.byteLength) throw new Error(`it ends before its last number; ${CUT}`);
        this.at += size;
        return this.view[`get${method}`](this.at - size, this.little);
    }

    finished() { return true; } // some writers add bytes
}

// The numbers of one property of one vertex, face or whatever it is: one, or a list's in an array.
function readProperty(numbers, { type, length }) {
    if (!length) return numbers.next(type);
    const count = numbers.next(length);
    if (!(count >= 0)) throw new Error(`a list has ${count} values; ${CUT}`);
    const list = [];
    for (let i = 0; i < count; i++) list.push(numbers.next(type));
    return list;
}

function readVertices(numbers, { count, properties }, polygons) {
    const find = (axis) => properties.findIndex(({ name, length }) => name === axis && !length);
    const axes = ['x', 'y', 'z'].map(find);
    if (axes.includes(-1)) throw new Error('its vertices have no x, y and z');
    const row = [];
    for (let v = 0; v < count; v++) {
        for (let p = 0; p < properties.length; p++) row[p] = readProperty(numbers, properties[p]);
        polygons.addVertex(row[axes[0]], row[axes[1]], row[axes[2]]);
    }
}

function readFaces(numbers, { count, properties }, polygons) {
    const corners = properties.findIndex(({ name, length }) => length && /^vertex_ind(ices|ex)$/.test(name));
    if (corners < 0) throw new Error("its faces have no list 'vertex_indices'");
    for (let f = 0; f < count; f++) {
        let face;
        for (let p = 0; p < properties.length; p++) {
            const value = readProperty(numbers, properties[p]);
            if (p === corners) face = value;
        }
        for (const corner of face) polygons.addCorner(corner);
        polygons.endPolygon();
    }
}

function skipElement(numbers, { count, properties }) {
    if (!properties.length) return;
    for (let i = 0; i < count; i++)
        for (const property of properties) readProperty(numbers, property);
}

export function readPly(bytes) {
    const { elements, format, data } = readHeader(bytes);
    const numbers = format === 'ascii' ? new TextNumbers(bytes, data)
        : new BinaryNumbers(bytes, data, format === 'binary_little_endian');
    const polygons = new Polygons();
    for (const element of elements) {
        if (element.name === 'vertex') readVertices(numbers, element, polygons);
        else if (element.name === 'face') readFaces(numbers, element, polygons);
        else if (element.name === 'tristrips') throw new Error('holds strips; export it with faces');
        else skipElement(numbers, element);
    }
    if (!numbers.finished()) throw new Error('holds more numbers than its header says; export it again');
    return polygons.finish();
}
