// draw.js - draws both views with WebGL2: bodies, obstacles, ground with shadow, and what is held.
import { add, cross, dot, unit } from 'view/camera';
import { Carry } from 'view/carry';
import { link } from 'view/program';
import { findGrounds, meshObstacles } from 'view/shapes';

const MAP = 512; // pixels of a side's shadow map
export const ATTRIBUTES = ['point', 'normal', 'apart']; // alike in all programs of surfaces
export const [POINT, NORMAL, APART] = ATTRIBUTES.keys();
export const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);

export const THEMES = {
    light: { name: 'light', back: '#f4f5f7', floor: '#e9ebee', ink: '#8c939d', stone: '#b4b8be',
        darkness: 0.42, sides: ['#0072b2', '#d55e00'] },
    dark: { name: 'dark', back: '#15181d', floor: '#20242b', ink: '#5b6370', stone: '#7d838c', darkness: 0.75,
        sides: ['#3c97cf', '#e57a2a'] },
};
const HELD = rgb('#f0e442');

// Buffers of one surface on the graphics card.
export class Mesh {
    constructor(gl) {
        this.gl = gl;
        this.array = gl.createVertexArray();
        [this.points, this.normals, this.indices] = [0, 1, 2].map(() => gl.createBuffer());
        gl.bindVertexArray(this.array);
        for (const [attribute, buffer] of [[POINT, this.points], [NORMAL, this.normals]]) {
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.enableVertexAttribArray(attribute);
            gl.vertexAttribPointer(attribute, 3, gl.FLOAT, false, 0, 0);
        }
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
        gl.bindVertexArray(null);
        this.count = 0;
    }

    set(surface) {
        const { gl } = this;
        for (const [buffer, values] of [[this.points, surface.points], [this.normals, surface.normals]]) {
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
        }
        this.setTriangles(surface);
    }

    setTriangles(surface) {
        const { gl } = this;
        gl.bindVertexArray(this.array);
        if (surface.version === undefined || surface.version !== this.version)
            gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, surface.indices, gl.DYNAMIC_DRAW);
        gl.bindVertexArray(null);
        this.version = surface.version;
        this.count = surface.indices.length;
    }

    draw() {
        if (!this.count) return;
        this.gl.bindVertexArray(this.array);
        this.gl.drawElements(this.gl.TRIANGLES, this.count, this.gl.UNSIGNED_INT, 0);
    }
}

// A picture of one number a pixel, with smaller copies.
function makeMap(gl) {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, Math.log2(MAP) + 1, gl.R8, MAP, MAP);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return { texture, frame };
}

// 1, 2 or 5 times a power of ten, at most `most`.
function roundDown(most) {
    const power = 10 ** Math.floor(Math.log10(most));
    return power * [5, 2, 1].find((digit) => digit * power <= most * 1.0001);
}

export class Picture {
    constructor(canvas, shaders) {
        const gl = canvas.getContext('webgl2', { alpha: false, antialias: true });
        if (!gl) throw new Error('This browser has no WebGL2, which the page draws with.');
        this.gl = gl;
        this.canvas = canvas;
        for (const name of ['surface', 'shadow', 'ground', 'dot'])
            this[name] = link(gl, shaders[`${name}.vert`], shaders[`${name}.frag`], ATTRIBUTES);
        this.bodies = [new Mesh(gl), new Mesh(gl)];
        this.maps = [makeMap(gl), makeMap(gl)];
        this.stones = new Mesh(gl);
        this.dots = new Mesh(gl);
        this.carries = [0, 1].map(() => new Carry(gl, shaders['carry.vert']));
        this.grounds = [];
    }

    // The scene's obstacles, and the ground under what is within `bounds` at rest.
    setScene(bounds, obstacles) {
        this.stones.set(meshObstacles(obstacles));
        for (const one of [...this.bodies, ...this.carries]) one.version = undefined; // numbers of another scene
        this.inside?.opened();
        const middle = add(bounds.low, bounds.high).map((x) => x / 2);
        const reach = 0.5 * Math.hypot(...add(bounds.high, bounds.low, -1)) || 1;
        this.grounds = findGrounds(bounds, obstacles).map(({ point, normal }) => {
            const across = unit(cross(normal, Math.abs(normal[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
            const along = cross(across, normal);
            const under = add(middle, normal, -dot(normal, add(middle, point, -1)));
            return { middle: under, across, along, upward: normal, reach: 1.7 * reach, extent: 4.5 * reach,
                spacing: roundDown(0.4 * reach) };
        });
    }

    setSurface(side, surface) {
        this.bodies[side].set(surface);
        this.inside?.moved(side);
    }

    // Is there no graphics card, and shaders run on the processor?
    isSoftware() {
        const told = this.gl.getExtension('WEBGL_debug_renderer_info');
        const name = told ? this.gl.getParameter(told.UNMASKED_RENDERER_WEBGL) : '';
        return /swiftshader|llvmpipe|software/i.test(name);
    }

    // The same by the shader, of what carries the surface and of where that is.
    carrySurface(side, carried, places) {
        const body = this.bodies[side];
        body.setTriangles(carried);
        this.carries[side].run(carried, places, body.points, body.normals);
        this.inside?.moved(side);
    }

    // Points and normals as they are on the graphics card.
    readSurface(side) {
        const { gl, bodies } = this;
        return [bodies[side].points, bodies[side].normals].map((buffer) => {
            gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
            const values = new Float32Array(gl.getBufferParameter(gl.ARRAY_BUFFER, gl.BUFFER_SIZE) / 4);
            gl.getBufferSubData(gl.ARRAY_BUFFER, 0, values);
            return values;
        });
    }

    use({ program, at }, values) {
        const { gl } = this;
        gl.useProgram(program);
        for (const [name, value] of Object.entries(values)) {
            if (at[name] === undefined) continue;
            if (value.length === 16) gl.uniformMatrix4fv(at[name], false, value);
            else if (value.length === 3) gl.uniform3fv(at[name], value);
            else gl.uniform1f(at[name], value);
        }
    }

    drawShadow(side) {
        const { gl } = this;
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.maps[side].frame);
        gl.viewport(0, 0, MAP, MAP);
        gl.clearColor(0, 0, 0, 1);
        gl.clear(gl.COLOR_BUFFER_BIT);
        gl.disable(gl.DEPTH_TEST);
        gl.enable(gl.BLEND);
        gl.blendEquation(gl.MAX);
        this.use(this.shadow, this.grounds[0]);
        this.bodies[side].draw();
        gl.blendEquation(gl.FUNC_ADD);
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.bindTexture(gl.TEXTURE_2D, this.maps[side].texture);
        gl.generateMipmap(gl.TEXTURE_2D);
    }

    // Translucent, after all else: what is below the ground shows through it.
    drawGrounds(side, view, theme) {
        const { gl } = this;
        gl.enable(gl.BLEND);
        gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
        gl.depthMask(false);
        gl.bindTexture(gl.TEXTURE_2D, this.maps[side].texture);
        gl.bindVertexArray(null);
        this.grounds.forEach((ground, i) => {
            this.use(this.ground, { ...ground, view, ink: rgb(theme.ink), floorColour: rgb(theme.floor),
                darkness: i ? 0 : theme.darkness });
            gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
        });
        gl.depthMask(true);
    }

    // Its surface; `as` are values of surface.frag for this time.
    drawBody(side, { light, theme }, as = {}) {
        this.use(this.surface, { ...light, colour: rgb(theme.sides[side]), gloss: 0.12, ...as });
        this.bodies[side].draw();
    }

    drawDots(grips, view, size) {
        const { gl } = this;
        if (!grips.length) return;
        const points = new Float32Array(grips.flatMap(({ point }) => point));
        this.dots.set({ points, normals: points, indices: new Uint32Array(grips.keys()) });
        gl.disable(gl.DEPTH_TEST);
        this.use(this.dot, { view, size, colour: HELD });
        gl.bindVertexArray(this.dots.array);
        gl.drawArrays(gl.POINTS, 0, grips.length);
    }

    // One side into its part of the canvas: `box` in pixels from the lower left corner.
    drawSide(side, box, camera, grips, theme, ratio) {
        const { gl } = this;
        this.drawShadow(side);
        gl.viewport(box.x, box.y, box.width, box.height);
        gl.scissor(box.x, box.y, box.width, box.height);
        gl.enable(gl.SCISSOR_TEST);
        gl.clearColor(...rgb(theme.back), 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.enable(gl.DEPTH_TEST);
        gl.disable(gl.BLEND);
        const view = camera.matrix(box.width / box.height);
        const { right, up, back } = camera.axes();
        const lamp = unit(add(add(back.map((x) => 0.7 * x), right, -0.45), up, 0.75));
        const light = { view, eye: camera.eye(), lamp, most: 0, clearness: 0 };
        const scene = { box, camera, light, theme, ratio };
        this.use(this.surface, { ...light, colour: rgb(theme.stone), gloss: 0.02 });
        this.stones.draw();
        if (!this.inside?.drawBefore(side, scene)) this.drawBody(side, scene);
        this.drawGrounds(side, view, theme);
        this.inside?.drawAfter(side, scene);
        this.drawDots(grips, view, 13 * ratio);
        gl.disable(gl.SCISSOR_TEST);
    }
}
