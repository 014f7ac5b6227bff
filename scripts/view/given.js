// given.js - the meshes that the page has read, by name, and the one of them that the engines have
// (bench/view/given.h).
import { plainName } from 'view/mesh_files';
import { getString } from 'view/scene_text';

const MOST = 4; // meshes that are kept

export class Given {
    constructor(engine) {
        this.engine = engine;
        this.meshes = new Map(); // as readMesh() has them; the latest last
        this.forget();
    }

    // The engines have none.
    forget() { this.taken = null; }

    // Keeps a mesh that has been read, and of the others the latest. `meshes` before that is not changed.
    keep(name, mesh) {
        const others = [...this.meshes].filter(([other]) => other !== name);
        this.meshes = new Map([...others.slice(1 - MOST), [name, mesh]]);
    }

    // The name of the mesh file that a scene's text asks for; '' where it takes a shape of the program's.
    named(text) {
        const mesh = getString(text, 'mesh') ?? '';
        return mesh.startsWith('shape:') ? '' : plainName(mesh);
    }

    lacks(text) { return this.named(text) !== '' && !this.meshes.has(this.named(text)); }

    // Lets the engines have a mesh, unless they have it; '' or why they do not take it.
    give(name) {
        const mesh = this.meshes.get(name);
        if (!mesh || this.taken === mesh) return '';
        const { engine } = this;
        engine.call.view_given_room(mesh.points.length / 3, mesh.sizes.length, mesh.corners.length);
        const { buffer } = engine.call.memory;
        new Float64Array(buffer).set(mesh.points, engine.call.view_given_points() / 8);
        new Int32Array(buffer).set(mesh.sizes, engine.call.view_given_sizes() / 4);
        new Int32Array(buffer).set(mesh.corners, engine.call.view_given_corners() / 4);
        const refused = engine.string(engine.call.view_given_take(engine.give(name).at));
        this.taken = refused ? null : mesh;
        return refused;
    }

    // The text of the scene that drops the mesh that the engines have.
    sceneText() { return this.engine.string(this.engine.call.view_given_scene()); }
}
