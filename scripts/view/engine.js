// engine.js - the engines in WebAssembly (bench/view/view.h): what they import, their strings, and their
// numbers as arrays. A side is 0, FastLSM, or 1, the octree or, where the scene is of one, an elastic body or a shell.
import { Given } from 'view/given';

const NAMES = { fastlsm: 'FastLSM', octree: 'Octree', meshless: 'Elastic body', shell: 'Shell' };
export const [ELASTIC, ABSENT] = [1, 2]; // of what a scene's text is (bench/view/stored_bodies.h)
export const STAGES = ['fast sum', 'shape matching', 'polar', 'damping', 'other'];
const FIGURES = [
    'particles', 'regions', 'links', 'broken', 'contacts', 'summationNodes', 'buildMs', 'time',
    'steps', 'kinetic', 'momentum', 'cell', 'h', 'stepsPerFrame', 'pieces',
];
const OBSTACLES = ['plane', 'sphere', 'box', 'capsule'];
const CARRIED_ROW = 2048; // VIEW_ROW
const ENOSYS = 52;
const EBADF = 8;

// What the module imports of WASI: a clock and a place for messages; all else is not there.
function makeSystem(memory) {
    const view = () => new DataView(memory().buffer);
    return {
        clock_time_get(clock, precision, result) {
            const nanoseconds = BigInt(Math.round(performance.now() * 1e6));
            view().setBigUint64(result, nanoseconds, true);
            return 0;
        },
        fd_write(file, list, count, written) {
            let text = '';
            let bytes = 0;
            for (let i = 0; i < count; i++) {
                const at = view().getUint32(list + 8 * i, true);
                const length = view().getUint32(list + 8 * i + 4, true);
                text += new TextDecoder().decode(new Uint8Array(memory().buffer, at, length));
                bytes += length;
            }
            view().setUint32(written, bytes, true);
            if (text.trim()) console.error(text.trimEnd());
            return 0;
        },
        environ_sizes_get(count, size) {
            view().setUint32(count, 0, true);
            view().setUint32(size, 0, true);
            return 0;
        },
        environ_get: () => 0,
        fd_prestat_get: () => EBADF, // says that no folder is open; any other error ends the program
        proc_exit(code) { throw new Error(`the engine ended with code ${code}`); },
    };
}

export class Engine {
    // Makes the engines of the module's bytes; `bodies` are stored elastic ones.
    static async create(bytes, bodies) {
        const engine = new Engine();
        engine.bodies = bodies;
        engine.given = new Given(engine);
        engine.module = await WebAssembly.compile(bytes);
        await engine.restart();
        return engine;
    }

    // Begins anew with nothing open: after a trap the old memory is not to be trusted.
    async restart() {
        const system = makeSystem(() => this.call.memory);
        const imports = {};
        for (const { module, name } of WebAssembly.Module.imports(this.module))
            (imports[module] ??= {})[name] = system[name] ?? (() => ENOSYS);
        this.call = (await WebAssembly.instantiate(this.module, imports)).exports;
        this.held = new Set();
        this.given.forget();
        this.call._initialize?.();
        this.lacking = this.bodies.map((body) => this.takeBody(body)).find((refused) => refused) ?? '';
    }

    // '', or the line that says why these bytes are no stored body.
    takeBody(bytes) {
        const at = this.call.view_stored_room(bytes.length);
        new Uint8Array(this.call.memory.buffer).set(bytes, at);
        return this.string(this.call.view_stored_take());
    }

    string(at) {
        const bytes = new Uint8Array(this.call.memory.buffer);
        return at ? new TextDecoder().decode(bytes.subarray(at, bytes.indexOf(0, at))) : null;
    }

    // Puts text into the engine's room: where it is, and its bytes without the NUL after them.
    give(text) {
        const bytes = new TextEncoder().encode(`${text}\0`);
        const at = this.call.view_room(bytes.length);
        new Uint8Array(this.call.memory.buffer).set(bytes, at);
        return { at, length: bytes.length - 1 };
    }

    sceneNames() {
        const names = [];
        for (let at; (at = this.call.view_scene_name(names.length));) names.push(this.string(at));
        return names;
    }

    sceneText(name) { return this.string(this.call.view_scene_text(this.give(name).at)); }

    // '', or the line that says why nothing has changed. With `keep` grips stay, too.
    open(text, keep) {
        const refused = this.given.give(this.given.named(text));
        if (refused) return refused;
        if (this.call.view_open(this.give(text).length, keep ? 1 : 0))
            return this.string(this.call.view_message());
        if (!keep) this.held.clear();
        return '';
    }

    // Whether a scene's text is of an elastic body, ELASTIC, and of one that the page has not got, ABSENT.
    elastic(text) { return this.call.view_stored_for(this.give(text).length); }

    // The name of a side's engine, and how people call it.
    kind(side) { return this.string(this.call.view_engine(side)); }
    sideName(side) { return NAMES[this.kind(side)]; }

    absent(side) { return this.string(this.call.view_absent(side)); }
    step(side, steps) { this.call.view_step(side, steps); }

    // The sides that are there and shown; one of them at least, if any is there.
    present() {
        const there = [0, 1].filter((side) => !this.absent(side));
        const shown = there.filter((side) => this.only === undefined || side === this.only);
        return shown.length ? shown : there;
    }

    figure(side, name) { return this.call.view_figure(side, FIGURES.indexOf(name)); }
    stages(side) { return STAGES.map((name, stage) => this.call.view_stage_ms(side, stage)); }
    // What the side's engine calls a stage; null where it has no such.
    stageName(side, stage) {
        return this.string(this.call.view_stage_name(side, stage))?.replaceAll('_', ' ') ?? null;
    }

    paperPercent(side, stage) { return this.call.view_paper_percent(side, stage); }
    clearStages(side) { this.call.view_clear_stages(side); }

    // The surface now; its arrays hold until the next call.
    surface(side) {
        const version = this.call.view_surface(side);
        const vertices = this.call.view_vertices(side);
        const triangles = this.call.view_triangles(side);
        const buffer = this.call.memory.buffer;
        return {
            version,
            points: new Float32Array(buffer, this.call.view_points(side), 3 * vertices),
            normals: new Float32Array(buffer, this.call.view_normals(side), 3 * vertices),
            indices: new Uint32Array(buffer, this.call.view_indices(side), 3 * triangles),
        };
    }

    // What carries the surface of a side for a shader (carried.h), or null; its arrays hold until the next
    // call, as does where particles are now.
    carried(side) {
        const { call } = this;
        const version = call.view_carried(side);
        if (!version) return null;
        const [vertices, particles] = [call.view_carried_vertices(side), call.view_carried_particles(side)];
        const { buffer } = call.memory;
        return {
            version, vertices, particles, bodies: call.view_carried_bodies(side), row: CARRIED_ROW,
            carriers: new Int32Array(buffer, call.view_carriers(side), 8 * vertices),
            weights: [0, 1, 2].map((which) =>
                new Float32Array(buffer, call.view_carried_weights(side, which), 8 * vertices)),
            indices: new Uint32Array(buffer, call.view_indices(side), 3 * call.view_triangles(side)),
        };
    }

    places(side, { particles, bodies, row }) {
        const at = this.call.view_places(side);
        return new Float32Array(this.call.memory.buffer, at, 4 * row * Math.ceil(particles * bodies / row));
    }

    doubles(at, count) { return [...new Float64Array(this.call.memory.buffer, at, count)]; }

    bounds() {
        const box = this.doubles(this.call.view_bounds(), 6);
        return { low: box.slice(0, 3), high: box.slice(3) };
    }

    obstacles() {
        return Array.from({ length: this.call.view_obstacles() }, (_, number) => {
            const n = this.doubles(this.call.view_obstacle(number), 8);
            return { kind: OBSTACLES[n[0]], a: n.slice(1, 4), b: n.slice(4, 7), radius: n[7] };
        });
    }

    // The number of the grip on what is around a vertex, or -1.
    grab(side, vertex, radius) {
        const grip = this.call.view_grab(side, vertex, radius);
        if (grip >= 0) this.held.add(grip);
        return grip;
    }

    drag(grip, by) { this.call.view_drag(grip, by[0], by[1], by[2]); }

    release(grip) {
        this.call.view_release(grip);
        this.held.delete(grip);
    }

    // What else hands do (view.h): bodies are made for it by the next open() that keeps motion.
    allowCut() { this.call.view_allow_cut(); }
    allowTouch(body) { this.call.view_allow_touch(body); }
    mayCut(side) { return this.call.view_may_cut(side) !== 0; }
    mayTouch(side, body) { return this.call.view_may_touch(side, body) !== 0; }
    cut(a, b) { return this.call.view_cut(...a, ...b) > 0; }
    lift() { this.call.view_lift(); }
    body(side, vertex) { return this.call.view_body(side, vertex); }
    touch(side, vertex, radius) { this.call.view_touch(side, vertex, radius); }
    leave() { this.call.view_leave(); }
    blow(wind) { this.call.view_blow(...wind); }

    // Where the held grips are on a side: [{ grip, point }].
    grips(side) {
        return [...this.held].flatMap((grip) => {
            const at = this.call.view_grip(side, grip);
            return at ? [{ grip, point: this.doubles(at, 3) }] : [];
        });
    }
}
