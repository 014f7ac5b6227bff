// mesh_polygons.js - what a mesh file comes to: positions, and polygons of them.

const MOST = 1e6; // triangles; a page draws each on both sides
const NOWHERE = -1; // the number of a vertex that is not there

// An array that grows.
class Growing {
    constructor(Type) {
        this.array = new Type(4096);
        this.length = 0;
    }

    push(value) {
        if (this.length === this.array.length) {
            const larger = new this.array.constructor(2 * this.length);
            larger.set(this.array);
            this.array = larger;
        }
        this.array[this.length++] = value;
    }

    filled() { return this.array.subarray(0, this.length); }
}

export class Polygons {
    constructor() {
        this.coordinates = new Growing(Float64Array);
        this.corners = new Growing(Int32Array);
        this.sizes = new Growing(Int32Array);
        this.triangles = 0;
        this.size = 0; // of the polygon that is being read
    }

    get vertices() { return this.coordinates.length / 3; }

    addVertex(x, y, z) {
        if (this.vertices >= 4 * MOST) throw new Error(`holds more than ${4 * MOST} vertices: simplify it`);
        this.coordinates.push(x);
        this.coordinates.push(y);
        this.coordinates.push(z);
    }

    // The next corner of the polygon that is being read: a vertex's number, from 0.
    addCorner(vertex) {
        const there = Number.isInteger(vertex) && vertex >= 0 && vertex < 2 ** 31;
        this.corners.push(there ? vertex : NOWHERE);
        this.size++;
    }

    endPolygon() {
        this.sizes.push(this.size);
        this.triangles += Math.max(this.size - 2, 0);
        this.size = 0;
        if (this.triangles > MOST)
            throw new Error(`holds more than the ${MOST} triangles that a page takes: simplify it`);
    }

    // { points, corners, sizes } for the engine, of a file with triangles in it.
    finish() {
        if (!this.triangles && this.vertices)
            throw new Error('holds only points or lines, no triangles; a page takes meshes of triangles');
        if (!this.triangles) throw new Error('holds no triangles');
        return {
            points: this.coordinates.filled(), corners: this.corners.filled(), sizes: this.sizes.filled(),
        };
    }
}
