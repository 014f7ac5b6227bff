// inside_engine.js - what the engines say of their inside (bench/view/inside.h), as arrays that hold until
// the next call.

const BARS = 0, PLATES = 1, NODES = 2, GOAL_CELLS = 3;
export const CELL = 13; // numbers of a cell: its middle, three half edges, its level
export const BOX = 25; // of a summation node's cell: eight corners, its level

export class InsideEngine {
    constructor(engine) { this.engine = engine; }

    get call() { return this.engine.call; } // another after a restart
    floats(at, count) { return new Float32Array(this.call.memory.buffer, at, at ? count : 0); }
    integers(at, count) { return new Int32Array(this.call.memory.buffer, at, at ? count : 0); }

    points(side) {
        const at = this.call.view_particle_points(side);
        return this.floats(at, 3 * this.call.view_particles(side));
    }

    linkCount(side) { return this.call.view_links(side); }

    // The links' ends; the first `straight` links are along the lattice's axes.
    links(side) {
        const at = this.call.view_link_ends(side);
        const ends = this.integers(at, 2 * this.linkCount(side));
        return { ends, straight: this.call.view_straight_links(side) };
    }

    cells(side) {
        const at = this.call.view_cell_frames(side);
        return this.floats(at, CELL * this.call.view_cells(side));
    }

    // A particle's region, null where there is no such particle. `members`: three numbers each, itself, its
    // bar or summation node, and its plate.
    mark(side, particle) {
        const { call } = this;
        const count = call.view_mark(side, particle);
        if (!count) return null;
        const [bars, plates, nodes, goalCells] = [BARS, PLATES, NODES, GOAL_CELLS]
            .map((figure) => call.view_mark_figure(side, figure));
        return {
            particle, count, bars, plates, nodes, goalCells,
            members: this.integers(call.view_members(side), 3 * count).slice(),
            boxes: this.floats(call.view_boxes(side), BOX * nodes).slice(),
            goal: this.engine.doubles(call.view_goal(side), 3),
        };
    }

    // The surface at rest, to be drawn with the triangles of the surface now.
    rest(side) {
        const count = 3 * this.call.view_vertices(side);
        const points = this.call.view_rest_points(side);
        const normals = this.call.view_rest_normals(side);
        return { points: this.floats(points, count), normals: this.floats(normals, count) };
    }

    // Cells between each vertex and that of the other side, both found anew: the shader may have drawn them.
    // Empty where they cannot be compared.
    difference(side) {
        for (const one of this.engine.present()) this.call.view_surface(one);
        const at = this.call.view_difference(side);
        return this.floats(at, this.call.view_vertices(side));
    }

    notComparable() { return this.engine.string(this.call.view_not_comparable()); }
}
