// given.js - the mesh files that the page has, by name, and the one of them that the engines have read
// (bench/view/given.h).
import { getString } from 'view/scene_text';

const MOST = 4; // meshes that are kept

// A file's name as a scene's text and messages can have it.
export const plainName = (name) => name.replace(/^.*[/\\]/, '').replace(/["\p{C}]|^shape:/gu, '_');

export class Given {
    constructor(engine) {
        this.engine = engine;
        this.meshes = new Map(); // of each its files, as take() has them; the latest last
        this.forget();
    }

    // The engines have none.
    forget() { this.taken = null; }

    readable(name) { return this.engine.call.view_given_readable(this.engine.give(name).at) !== 0; }

    // Reads a mesh file and what lies beside it, [{ name, bytes }, ...]: '', or why not. Then keeps it, and of
    // the others the latest. `meshes` before that is not changed.
    take(files) {
        const refused = this.read(files);
        if (refused) return refused;
        const [{ name }] = files;
        const others = [...this.meshes].filter(([other]) => other !== name);
        this.meshes = new Map([...others.slice(1 - MOST), [name, files]]);
        return '';
    }

    read(files) {
        const { engine } = this;
        for (const { name, bytes } of files) {
            const at = engine.call.view_given_room(engine.give(name).at, bytes.length);
            new Uint8Array(engine.call.memory.buffer).set(bytes, at);
        }
        const refused = engine.string(engine.call.view_given_take(engine.give(files[0].name).at));
        this.taken = refused ? null : files;
        return refused;
    }

    // The name of the mesh file that a scene's text asks for; '' where it takes a shape of the program's.
    named(text) {
        const mesh = getString(text, 'mesh') ?? '';
        return mesh.startsWith('shape:') ? '' : plainName(mesh);
    }

    lacks(text) { return this.named(text) !== '' && !this.meshes.has(this.named(text)); }

    // Lets the engines have the mesh of that name, if the page has it: '', or why they do not take it.
    give(name) {
        const files = this.meshes.get(name);
        return files && this.taken !== files ? this.read(files) : '';
    }

    // What of the mesh's file the engines have not; the text of the scene that drops the mesh.
    leftOut() { return this.engine.string(this.engine.call.view_given_left_out()); }
    sceneText() { return this.engine.string(this.engine.call.view_given_scene()); }
}
