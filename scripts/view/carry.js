// carry.js - a lattice's surface by a vertex shader (carry.vert; fastlsm section 4): particles go up as a
// texture, vertices and normals stay on the graphics card.
import { link } from 'view/program';

const ATTRIBUTES = ['carriers0', 'carriers1', 'phi0', 'phi1', 'u0', 'u1', 'v0', 'v1'];
const NOTHING = '#version 300 es\nvoid main() {}\n';

export class Carry {
    constructor(gl, shader) {
        this.gl = gl;
        this.shader = link(gl, shader, NOTHING, ATTRIBUTES, ['place', 'facing']);
        this.array = gl.createVertexArray();
        [this.carriers, ...this.weights] = [0, 1, 2, 3].map(() => gl.createBuffer());
        this.feedback = gl.createTransformFeedback();
        this.texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, this.texture);
        for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
            gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST); // such textures have no other
    }

    // What carries each vertex: once for a surface.
    load(carried) {
        const { gl } = this;
        gl.bindVertexArray(this.array);
        [this.carriers, ...this.weights].forEach((buffer, i) => {
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, i ? carried.weights[i - 1] : carried.carriers, gl.STATIC_DRAW);
            for (const half of [0, 1]) {
                gl.enableVertexAttribArray(2 * i + half);
                if (i) gl.vertexAttribPointer(2 * i + half, 4, gl.FLOAT, false, 32, 16 * half);
                else gl.vertexAttribIPointer(2 * i + half, 4, gl.INT, 32, 16 * half);
            }
        });
        gl.bindVertexArray(null);
        this.version = carried.version;
    }

    // Vertices and normals of all bodies into two buffers, which are made as large.
    run(carried, places, points, normals) {
        const { gl } = this;
        const [width, height] = [carried.row, places.length / 4 / carried.row];
        if (carried.version !== this.version) this.load(carried);
        gl.bindTexture(gl.TEXTURE_2D, this.texture);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, places);
        for (const buffer of [points, normals]) {
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, 12 * carried.vertices * carried.bodies, gl.DYNAMIC_COPY);
        }
        gl.bindBuffer(gl.ARRAY_BUFFER, null);
        gl.useProgram(this.shader.program);
        gl.uniform1f(this.shader.at.particles, carried.particles);
        gl.bindVertexArray(this.array);
        gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, this.feedback);
        [points, normals].forEach((buffer, i) => gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, i, buffer));
        gl.enable(gl.RASTERIZER_DISCARD);
        gl.beginTransformFeedback(gl.POINTS);
        gl.drawArraysInstanced(gl.POINTS, 0, carried.vertices, carried.bodies);
        gl.endTransformFeedback();
        gl.disable(gl.RASTERIZER_DISCARD);
        [0, 1].forEach((i) => gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, i, null));
        gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, null);
        gl.bindVertexArray(null);
    }
}
