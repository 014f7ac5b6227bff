// files.js - files that are dropped on the page or chosen there: meshes, what lies beside them, and scenes.
import { plainName } from 'view/given';

const $ = (id) => document.getElementById(id);
const LARGEST = 400e6; // bytes, as text of a million triangles at most
const UNKNOWN = 'the page cannot open it; it opens OBJ, PLY, STL, OFF, glTF and GLB meshes, and scenes (.cfg)';
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
        const [meshes, others] = [[], []];
        let [text, name, said] = ['', '', ''];
        for (const file of files) {
            try {
                const bytes = await this.read(file);
                const to = given.readable(file.name) ? meshes : others;
                if (isScene(file.name)) text = new TextDecoder().decode(bytes);
                else to.push({ name: plainName(file.name), bytes });
            } catch (error) {
                said = `${plainName(file.name)}: ${error.message}`;
            }
        }
        if (others.length && !meshes.length) said = `${others[0].name}: ${UNKNOWN}`;
        for (const mesh of meshes) {
            const refused = await this.take([mesh, ...others]);
            if (refused) said = refused;
            else ({ name } = mesh);
        }
        if (!text && !name) return this.app.say(said);
        const why = await this.show(text, name).catch((error) => error.message);
        if (why) given.meshes = before;
        return this.app.say(why || said || (name && given.leftOut()));
    }

    // Keeps the mesh of these files (Given.take()): '', or why not.
    async take(files) {
        try {
            return this.app.engine.given.take(files);
        } catch (trap) {
            return `${files[0].name}: ${await this.app.recover(trap)}`;
        }
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
