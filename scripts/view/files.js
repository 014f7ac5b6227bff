// files.js - files that are dropped on the page or chosen there: meshes and scenes.
import { isMeshFile, LARGEST, plainName, readMesh } from 'view/mesh_files';

const $ = (id) => document.getElementById(id);
const UNKNOWN = 'a page opens meshes (.obj, .ply, .stl, .off) and scenes (.cfg): export it as one';
const isScene = (name) => /\.cfg$/i.test(name);
const hasFiles = (event) => event.dataTransfer?.types.includes('Files');

export class Files {
    constructor(app) {
        this.app = app;
        this.last = Promise.resolve(); // one after the other
        const open = (list) => {
            const files = [...list]; // which the browser empties soon
            if (files.length) this.last = this.last.then(() => this.open(files));
        };
        $('open').addEventListener('click', () => $('files').click());
        $('files').addEventListener('change', () => {
            open($('files').files);
            $('files').value = ''; // the same one may be chosen again
        });
        const mark = (on) => document.body.classList.toggle('dropping', on);
        window.addEventListener('dragover', (event) => {
            if (!hasFiles(event)) return;
            event.preventDefault();
            mark(true);
        });
        window.addEventListener('dragleave', (event) => { if (!event.relatedTarget) mark(false); });
        window.addEventListener('drop', (event) => {
            mark(false);
            if (!hasFiles(event)) return;
            event.preventDefault();
            open(event.dataTransfer.files);
        });
    }

    // Opens the last scene among them with the meshes, or else the last mesh. What cannot be opened is said,
    // and then all is as before.
    async open(files) {
        const { given } = this.app.engine;
        const before = given.meshes;
        let [text, name, refused] = ['', '', ''];
        for (const file of files) {
            try {
                const bytes = await this.read(file);
                if (isScene(file.name)) text = new TextDecoder().decode(bytes);
                else name = this.take(file.name, bytes);
            } catch (error) {
                refused = `${plainName(file.name)}: ${error.message}`;
            }
        }
        if (!text && !name) return this.app.say(refused);
        const why = await this.show(text, name).catch((error) => error.message);
        if (why) given.meshes = before;
        return this.app.say(why || refused); // what comes beside a mesh, such as its materials, is not used
    }

    // Keeps the mesh of a file's bytes, and returns its name in a scene's text. Throws what is wrong with it.
    take(file, bytes) {
        const name = plainName(file);
        this.app.engine.given.keep(name, readMesh(file, bytes));
        return name;
    }

    // Opens a scene's text, or, of '', that which waits for the mesh of that name, or else drops the mesh.
    // '', or why not.
    async show(text, name) {
        const { app } = this;
        const { given } = app.engine;
        if (text || !name) return app.visit(text);
        if (given.named(app.awaited) === name) return app.visit(app.awaited);
        try {
            return given.give(name) || await app.visit(given.sceneText());
        } catch (trap) {
            return app.recover(trap);
        }
    }

    // The file's bytes.
    async read(file) {
        if (!isScene(file.name) && !isMeshFile(file.name)) throw new Error(UNKNOWN);
        if (file.size > LARGEST)
            throw new Error(`is larger than the ${LARGEST / 1e6} MB that a page takes: simplify it`);
        this.app.say(`Reading ${plainName(file.name)} …`);
        await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
        try {
            return new Uint8Array(await file.arrayBuffer());
        } catch (error) {
            throw new Error(`cannot be read: ${error.message}`); // a folder, or it is gone
        }
    }
}
