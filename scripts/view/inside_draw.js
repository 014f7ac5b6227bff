// inside_draw.js - draws what is inside a body: particles and links, cells, a region with its sums.
import { APART, ATTRIBUTES, Mesh, rgb } from 'view/draw';
import { link } from 'view/program';
import { BOX, CELL } from 'view/inside_engine';

// Colours of levels from base cells on, and of what belongs to a region: apart from both sides' colours, and
// from each other in lightness, too.
const TONES = {
    light: { levels: ['#2b2f77', '#1f6fb4', '#0b8a6f', '#8a6d00', '#b5403a', '#6d1f5e', '#444444', '#000000'],
        member: '#00694b', marked: '#000000', bar: '#b0307c', plate: '#3b3f46', goal: '#ffffff' },
    dark: { levels: ['#8f8ff0', '#5fb4f0', '#4fd3b0', '#f0e442', '#ff9d76', '#f5a5de', '#c8c8c8', '#ffffff'],
        member: '#5fe0b0', marked: '#ffffff', bar: '#f08cc6', plate: '#d5d9de', goal: '#ffffff' },
};
export const tones = (theme) => TONES[theme.name];

const TOGETHER = 5; // pixels of a cell below which bars cannot be told apart, and are left out

// Pairs of a box's corners.
const EDGES = [0, 1, 2].flatMap((d) =>
    [...Array(8).keys()].filter((c) => !(c >> d & 1)).map((c) => [c, c | 1 << d]));

// Instances of one kind of line, whose attributes follow each other.
class Instances {
    constructor(gl, sizes) {
        Object.assign(this, { gl, array: gl.createVertexArray(), buffer: gl.createBuffer(), count: 0 });
        this.each = sizes.reduce((sum, size) => sum + size);
        gl.bindVertexArray(this.array);
        gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
        let offset = 0;
        sizes.forEach((size, attribute) => {
            gl.enableVertexAttribArray(attribute);
            gl.vertexAttribPointer(attribute, size, gl.FLOAT, false, 4 * this.each, 4 * offset);
            gl.vertexAttribDivisor(attribute, 1);
            offset += size;
        });
        gl.bindVertexArray(null);
    }

    set(values) {
        this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffer);
        this.gl.bufferData(this.gl.ARRAY_BUFFER, values, this.gl.DYNAMIC_DRAW);
        this.count = values.length / this.each;
    }

    draw(mode, vertices, count = this.count) {
        this.gl.bindVertexArray(this.array);
        this.gl.drawArraysInstanced(mode, 0, vertices, count);
    }
}

const hasGoal = (mark) => Number.isFinite(mark.goal[0]); // an elastic body's node has none

// The lines from a particle to its goal, and those that show what sums its region: from, to, colour, width.
function linesOf(mark, points, colours) {
    const lines = [];
    const at = (particle) => points.subarray(3 * particle, 3 * particle + 3);
    const add = (from, to, colour, width) => lines.push(...from, ...to, ...rgb(colour), width);
    const bars = Array.from({ length: mark.bars }, () => []);
    const plates = Array.from({ length: mark.plates }, () => []);
    for (let i = 0; i < mark.count && mark.bars; i++) {
        const [particle, bar, plate] = mark.members.subarray(3 * i, 3 * i + 3);
        if (!bars[bar].length) plates[plate].push(bars[bar]);
        bars[bar].push(particle);
    }
    if (hasGoal(mark)) add(at(mark.particle), mark.goal, colours.marked, 2.5);
    for (const plate of plates) { // round its bars' ends
        const ends = [...plate.map((bar) => bar[0]), ...plate.map((bar) => bar.at(-1)).reverse()];
        ends.forEach((end, i) => add(at(end), at(ends[(i + 1) % ends.length]), colours.plate, 1.5));
    }
    for (const bar of bars)
        for (let i = 1; i < bar.length; i++) add(at(bar[i - 1]), at(bar[i]), colours.bar, 3);
    for (let node = 0; node < mark.nodes; node++) {
        const box = mark.boxes.subarray(BOX * node, BOX * node + BOX);
        const corner = (c) => box.subarray(3 * c, 3 * c + 3);
        const colour = colours.levels[Math.min(7, box[BOX - 1])];
        for (const [a, b] of EDGES) add(corner(a), corner(b), colour, 2.5);
    }
    return new Float32Array(lines);
}

// One side's buffers.
class SideBuffers {
    constructor(gl) {
        this.points = new Mesh(gl); // its triangles' numbers are the links' ends
        this.cells = new Instances(gl, [3, 3, 3, 3, 1]);
        this.lines = new Instances(gl, [3, 3, 4]);
        this.dots = new Mesh(gl);
        this.ghost = new Mesh(gl);
        this.apart = gl.createBuffer();
    }
}

export class InsidePicture {
    constructor(picture, shaders) {
        const { gl } = picture;
        Object.assign(this, { gl, picture });
        for (const name of ['wire', 'cell', 'line'])
            this[name] = link(gl, shaders[`${name}.vert`], shaders['wire.frag'], ATTRIBUTES);
        this.sides = [new SideBuffers(gl), new SideBuffers(gl)];
    }

    setPoints(side, points) {
        const { array, points: buffer } = this.sides[side].points;
        this.gl.bindVertexArray(array);
        this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
        this.gl.bufferData(this.gl.ARRAY_BUFFER, points, this.gl.DYNAMIC_DRAW);
        this.sides[side].pointCount = points.length / 3;
    }

    setLinks(side, { ends, straight }) {
        const { gl } = this;
        gl.bindVertexArray(this.sides[side].points.array);
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, ends, gl.DYNAMIC_DRAW);
        gl.bindVertexArray(null);
        Object.assign(this.sides[side], { straight, links: ends.length / 2 });
    }

    setCells(side, cells) { this.sides[side].cells.set(cells); }

    // The mesh's points and normals at rest, or none.
    setGhost(side, surface) { this.sides[side].ghost.set(surface); }

    // How far vertices are from the other side's, for the body's own buffers; none: 0 of all.
    setApart(side, values) {
        const { gl, sides } = this;
        gl.bindVertexArray(this.picture.bodies[side].array);
        gl.bindBuffer(gl.ARRAY_BUFFER, sides[side].apart);
        if (values.length) {
            gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
            gl.enableVertexAttribArray(APART);
            gl.vertexAttribPointer(APART, 1, gl.FLOAT, false, 0, 0);
        } else {
            gl.disableVertexAttribArray(APART);
        }
        gl.bindVertexArray(null);
    }

    setMark(side, mark, points, theme) {
        const { lines, dots } = this.sides[side];
        lines.set(linesOf(mark, points, tones(theme)));
        const members = [];
        for (let i = 0; i < mark.count; i++) members.push(mark.members[3 * i]);
        const order = [...members.filter((particle) => particle !== mark.particle), mark.particle];
        const at = (particle) => [...points.subarray(3 * particle, 3 * particle + 3)];
        const places = new Float32Array([...order.flatMap(at), ...mark.goal]);
        this.sides[side].goals = hasGoal(mark) ? 1 : 0;
        dots.set({ points: places, normals: places, indices: new Uint32Array(0) });
        Object.assign(this.sides[side], { members: order.length - 1, bars: mark.bars });
    }

    wireValues(theme, { camera, light }) {
        return { view: light.view, behind: rgb(theme.back), middle: camera.distance, reach: camera.size };
    }

    blend() {
        this.gl.enable(this.gl.BLEND);
        this.gl.blendFunc(this.gl.ONE, this.gl.ONE_MINUS_SRC_ALPHA);
    }

    // A share of a finest cell's edge as it is seen, in pixels between two bounds.
    pixels({ box, camera, cell, ratio }, share, least, most) {
        const seen = share * cell * box.height / 2 / camera.reach();
        return Math.max(least * ratio, Math.min(most * ratio, seen));
    }

    drawLattice(side, scene, diagonals) {
        const { gl, picture } = this;
        const { points, straight, links } = this.sides[side];
        const { theme } = scene;
        this.blend();
        const colour = rgb(theme.sides[side]);
        picture.use(this.wire, { ...this.wireValues(theme, scene), colour, strength: 0.6 });
        gl.bindVertexArray(points.array);
        gl.drawElements(gl.LINES, 2 * straight, gl.UNSIGNED_INT, 0);
        gl.depthMask(false);
        picture.use(this.wire, { strength: 0.3 });
        if (diagonals) gl.drawElements(gl.LINES, 2 * (links - straight), gl.UNSIGNED_INT, 8 * straight);
        gl.depthMask(true);
        this.drawParticles(side, scene, 0.3, 1.5);
    }

    // Points of an array, `size` pixels each; small ones without the edge that would be all one sees of them.
    drawDots(array, scene, size, colour, first, count) {
        const { gl, picture } = this;
        const { ratio, theme } = scene;
        const values = { ...this.wireValues(theme, scene), size, colour: rgb(colour), strength: 1 };
        picture.use(size < 5 * ratio ? this.wire : picture.dot, values);
        gl.bindVertexArray(array);
        gl.drawArrays(gl.POINTS, first, count);
    }

    drawParticles(side, scene, share, least) {
        const { points, pointCount } = this.sides[side];
        const size = this.pixels(scene, share, least, 8);
        this.drawDots(points.array, scene, size, scene.theme.sides[side], 0, pointCount);
    }

    drawCells(side, scene) {
        const { gl, picture } = this;
        const { cells } = this.sides[side];
        this.blend();
        picture.use(this.cell, { ...this.wireValues(scene.theme, scene), strength: 1 });
        gl.uniform3fv(this.cell.at['levels[0]'], tones(scene.theme).levels.flatMap(rgb));
        cells.draw(gl.LINES, 24);
        this.drawParticles(side, scene, 1, 2);
    }

    // What is nearest alone, as glass; `draw(values)` draws the surface.
    drawGlass(draw, clearness) {
        const { gl } = this;
        gl.disable(gl.BLEND);
        gl.colorMask(false, false, false, false);
        draw({});
        gl.colorMask(true, true, true, true);
        gl.depthFunc(gl.LEQUAL);
        this.blend();
        draw({ clearness });
        gl.depthFunc(gl.LESS);
    }

    // Beside the body alone: in front of it, it would take the body's colours away.
    drawGhost(side, { light, theme }) {
        const { gl, picture } = this;
        picture.use(picture.surface, { ...light });
        gl.colorMask(false, false, false, false);
        gl.depthRange(0, 0);
        picture.bodies[side].draw();
        gl.depthRange(0, 1);
        gl.colorMask(true, true, true, true);
        this.drawGlass((as) => {
            picture.use(picture.surface, { ...light, colour: rgb(theme.stone), gloss: 0, ...as });
            this.sides[side].ghost.draw();
        }, 0.85);
    }

    // Over all else.
    drawMark(side, scene) {
        const { gl, picture } = this;
        const { box, ratio, theme } = scene;
        const { bars, dots, goals, lines, members } = this.sides[side];
        const colours = tones(theme);
        const dot = (...of) => this.drawDots(dots.array, scene, ...of);
        gl.clear(gl.DEPTH_BUFFER_BIT);
        this.blend();
        const screen = [box.width / 2, box.height / 2, this.pixels(scene, 0.12, 0.5, 1)];
        picture.use(this.line, { ...this.wireValues(theme, scene), strength: 1, screen });
        const together = bars && this.pixels(scene, 1, 0, Infinity) < TOGETHER * ratio;
        lines.draw(gl.TRIANGLE_STRIP, 4, together ? 1 : lines.count);
        gl.disable(gl.DEPTH_TEST);
        dot(this.pixels(scene, 0.5, 3, 8), colours.member, 0, members);
        dot(13 * ratio, colours.marked, members, 1);
        dot(8 * ratio, colours.goal, members + 1, goals);
        gl.enable(gl.DEPTH_TEST);
    }
}
