// main.js - starts the page: engines, buttons, the first scene, the loop of frames, and what tests use.
import { App } from 'view/app';
import { ABSENT, ELASTIC, Engine } from 'view/engine';
import { Files } from 'view/files';
import { plainName } from 'view/given';
import { getString } from 'view/scene_text';
import { fromBase64, saveFile, unzip } from 'view/share';

const FIRST_SCENE = 'hand';
const $ = (id) => document.getElementById(id);

// The menu's groups, by what is beside FastLSM, or else the paper.
const GROUPS = ['Octree', 'Elastic body', 'Thin shell', 'FastLSM', 'Others'];

function groupOf(text, engine) {
    const own = getString(text, 'engine');
    if (engine.elastic(text) === ELASTIC) return 'Elastic body';
    if (own === 'shell') return 'Thin shell';
    const paper = { octree: 'Octree', fastlsm: 'FastLSM' };
    return paper[own] ?? paper[getString(text, 'paper')] ?? 'Others';
}

// Scenes by their titles; elastic bodies that the page has not got are left out.
function fillMenu(menu, engine) {
    menu.append(new Option('(own text)', ''));
    menu.options[0].disabled = true;
    for (const label of GROUPS) {
        const group = Object.assign(document.createElement('optgroup'), { label });
        for (const name of engine.sceneNames()) {
            const text = engine.sceneText(name);
            if (engine.elastic(text) === ABSENT || groupOf(text, engine) !== label) continue;
            group.append(new Option(getString(text, 'title') ?? name, name));
        }
        menu.append(group);
    }
}

function wire(app) {
    const { engine } = app;
    fillMenu($('scene'), engine);
    $('scene').addEventListener('change', () => app.visit(app.engine.sceneText($('scene').value)));
    const does = {
        pause: () => app.pause(app.playing), step: () => app.once(), reset: () => app.reset(),
        look: () => app.frame(), pin: () => $('pin').setAttribute('aria-pressed', !app.pinning()),
        unpin: () => app.hands.releaseAll(),
        picture: () => app.picturePNG(), video: () => app.saveVideo(), link: () => app.copyLink(),
        file: () => saveFile('scene.cfg', new Blob([app.text], { type: 'text/plain' })),
        theme: () => app.setTheme($('theme').getAttribute('aria-pressed') !== 'true'),
        original: () => app.visit(app.original),
    };
    if (app.picture.isSoftware()) $('carrier').value = 'processor';
    $('sides').addEventListener('change', () => app.showOnly([undefined, 0, 1][$('sides').selectedIndex]));
    $('carrier').addEventListener('change', () => app.showSurfaces());
    for (const tool of document.querySelectorAll('#tools input'))
        tool.addEventListener('change', () => app.tools.choose(tool.value));
    for (const [id, action] of Object.entries(does)) $(id).addEventListener('click', action);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => app.setTheme(dark.matches));
    app.setTheme(dark.matches);
    new ResizeObserver(() => app.resized()).observe($('canvas'));
    window.addEventListener('hashchange', () => app.openLink());
}

// The link's scene, else the page's own, or that which drops its mesh, else the first; what was refused is
// said. The page's mesh may be the link's, too.
async function openFirst(app, { scene, mesh }) {
    const files = await Promise.all(mesh.map(async ({ name, gzip }) => (
        { name: plainName(name), bytes: await unzip(fromBase64(gzip), 'gzip') })));
    const unread = files.length ? await app.files.take(files) : '';
    const name = files.length && !unread ? files[0].name : '';
    let refused = unread || app.engine.lacking;
    const ways = [() => app.openLink(), () => app.visit(app.engine.sceneText(FIRST_SCENE))];
    if (scene || name) ways.splice(1, 0, () => app.files.show(scene, name));
    for (const open of ways) {
        const why = await open();
        refused ||= why;
        if (why === '') break;
    }
    app.say(refused || (name && app.engine.given.leftOut()));
}

async function start() {
    const data = JSON.parse($('data').textContent);
    const bodies = await Promise.all(data.bodies.map((body) => unzip(fromBase64(body), 'gzip')));
    const engine = await Engine.create(await unzip(fromBase64($('wasm').textContent), 'gzip'), bodies);
    const app = new App(engine, data.shaders);
    wire(app);
    app.files = new Files(app);
    await openFirst(app, data);
    const loop = (now) => { app.tick(now); requestAnimationFrame(loop); };
    requestAnimationFrame(loop);
    return app;
}

// What tests and films use; all but `ready` is there when that is done.
window.shapebench = {
    ready: start().then((app) => {
        Object.assign(window.shapebench, {
            engine: app.engine,
            camera: app.camera,
            files: app.files,
            film: app.film,
            inside: app.inside,
            advance: (frames) => app.advance(frames),
            copyViews: (canvas) => app.copyViews(canvas),
            pause: () => app.pause(true),
            text: () => app.text,
            busy: () => app.busy,
            open: (text, keep) => (keep ? app.open(text, true) : app.visit(text)),
            drawn: (side) => app.picture.readSurface(side),
            showSurface: (side) => app.showSurface(side),
            project: (...of) => app.project(...of),
        });
    }),
};
window.shapebench.ready.catch((error) => {
    $('status').textContent = `The page cannot run here: ${error.message}`;
});
