// app.js - the page's state: the scene's text, the engines and their pictures, and the frames.
import { Camera } from 'view/camera';
import { Picture, THEMES } from 'view/draw';
import { Film } from 'view/film';
import { Hands } from 'view/hands';
import { Inside } from 'view/inside';
import { Meter } from 'view/meter';
import { Panel } from 'view/panel';
import { getString } from 'view/scene_text';
import { copyWithCaptions, packScene, saveFile, unpackScene } from 'view/share';
import { findStage } from 'view/shapes';
import { Tools } from 'view/tools';

const WORK_MS = 25; // of steps in a frame, at most
const FRAME_MS = 1000 / 60; // faster screens do not make time run faster
const SHOW_MS = 200; // between two looks at the figures
const $ = (id) => document.getElementById(id);
const nextPaint = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));

export class App {
    constructor(engine, shaders) {
        this.engine = engine;
        this.views = [$('view-0'), $('view-1')];
        this.camera = new Camera();
        this.picture = new Picture($('canvas'), shaders);
        this.meters = [new Meter(), new Meter()];
        this.panel = new Panel(this);
        this.tools = new Tools(this);
        this.hands = new Hands(this);
        this.film = new Film($('video'));
        this.inside = this.picture.inside = new Inside(this, shaders);
        this.playing = true;
        Object.assign(this, { busy: false, stale: true, now: 0, last: 0, shown: 0, cost: 0 });
        this.text = this.awaited = '';
    }

    pinning() { return $('pin').getAttribute('aria-pressed') === 'true'; }
    say(words) { $('status').textContent = words; }
    changed() { this.stale = true; }

    resized() {
        this.changed();
        if (this.text) this.panel.show(this.meters);
    }

    // Opens a scene's text, or what a function makes of the one that is open when its turn comes; '' or why
    // not, and then all is as before. `keep`: motion goes on.
    open(text, keep) {
        const turn = () => this.openNow(typeof text === 'function' ? text() : text, keep);
        this.opening = (this.opening ?? Promise.resolve()).then(turn, turn);
        return this.opening;
    }

    async openNow(text, keep) {
        this.busy = true;
        this.say(getString(text, 'engine') === 'shell'
            ? 'Building: a shell\u2019s surface is mapped to a plane, which takes seconds …' : 'Building …');
        await nextPaint();
        let refused;
        try {
            refused = this.engine.open(text, keep);
        } catch (trap) {
            refused = await this.recover(trap);
        }
        this.busy = false;
        this.say('');
        if (!refused) this.opened(text, keep);
        return refused;
    }

    opened(text, keep) {
        this.text = text;
        const [bounds, obstacles] = [this.engine.bounds(), this.engine.obstacles()];
        this.picture.setScene(bounds, obstacles);
        [this.camera.floor] = this.picture.grounds;
        this.stage = findStage(bounds, obstacles);
        this.meters.forEach((meter) => (keep ? meter.begin() : meter.clear()));
        if (!keep) this.hands.forget();
        if (!keep) this.panel.forget();
        this.cost = 0;
        this.views.forEach((view, side) => {
            this.engine.clearStages(side);
            view.querySelector('.absent').textContent = this.engine.absent(side);
        });
        this.showNames();
        this.showSurfaces();
        this.tools.opened();
        this.panel.fill();
        this.panel.show(this.meters);
    }

    // Whose the sides are.
    showNames() {
        this.views.forEach((view, side) => {
            const name = this.engine.sideName(side);
            for (const place of document.querySelectorAll(`[data-name='${side}']`)) place.textContent = name;
            view.setAttribute('aria-label', `${name}. g takes hold, arrows turn the camera or pull.`);
        });
    }

    showSurfaces() {
        for (const side of [0, 1]) this.showSurface(side);
        this.changed();
    }

    // By the shader where eight particles carry each vertex, else by the processor.
    showSurface(side) {
        const carried = $('carrier').value === 'shader' ? this.engine.carried(side) : null;
        if (carried) this.picture.carrySurface(side, carried, this.engine.places(side, carried));
        else this.picture.setSurface(side, this.engine.surface(side));
    }

    // The engine has trapped: it begins anew with the scene that was open.
    async recover(trap) {
        const text = this.text;
        await this.engine.restart();
        this.text = '';
        try {
            if (text && !this.engine.open(text, false)) this.opened(text, false);
        } catch {
            await this.engine.restart(); // with nothing open
        }
        return `The engine stopped and has begun anew: ${trap.message}`;
    }

    // Opens another scene and looks at it, as open() does; the menu says which one is open now. One whose
    // mesh the page has not got is awaited.
    async visit(text) {
        const refused = await this.open(text, false);
        this.say(refused);
        if (refused && this.engine.given.lacks(text)) this.awaited = text;
        if (!refused && text === this.awaited) this.awaited = '';
        if (!refused) this.original = text;
        if (!refused) this.frame();
        const { engine } = this;
        const names = [...$('scene').options].map((option) => option.value);
        $('scene').value = names.find((name) => name && engine.sceneText(name) === this.original) ?? '';
        return refused;
    }

    frame() {
        if (!this.stage) return;
        const { width, height } = this.views[this.engine.only ?? 0].getBoundingClientRect();
        this.camera.frame(this.stage, width / height);
        this.changed();
    }

    // Steps of one frame on both sides; the milliseconds that stepping took.
    step(steps) {
        this.now += 1 / 60;
        let spent = 0;
        for (const side of this.engine.present()) {
            const begin = performance.now();
            this.engine.step(side, steps);
            const stepped = performance.now();
            spent += stepped - begin;
            this.showSurface(side);
            this.meters[side].add(steps, stepped - begin, performance.now() - begin);
            const [kinetic, momentum] = ['kinetic', 'momentum'].map((name) => this.engine.figure(side, name));
            this.meters[side].note(this.now, kinetic, momentum);
        }
        this.changed();
        return spent;
    }

    // Figures, lines and bars up to now.
    show(soon) {
        for (const side of this.engine.present())
            this.meters[side].settle(() => {
                const stages = this.engine.stages(side);
                this.engine.clearStages(side);
                return stages;
            }, soon, this.engine.figure(side, 'time'));
        this.panel.show(this.meters);
    }

    stepsPerFrame() { return this.engine.figure(this.engine.present()[0], 'stepsPerFrame') || 1; }

    // As many steps as the scene wants, or as there is time for.
    play() {
        const wanted = this.stepsPerFrame();
        const steps = this.cost ? Math.max(1, Math.min(wanted, Math.floor(WORK_MS / this.cost))) : 1;
        const cost = this.step(steps) / steps;
        this.cost = this.cost ? 0.7 * this.cost + 0.3 * cost : cost;
    }

    // Where the views are on the canvas, in its pixels from its lower left corner.
    boxes() {
        const whole = $('canvas').getBoundingClientRect();
        const ratio = $('canvas').width / whole.width;
        return this.views.map((view) => {
            const box = view.getBoundingClientRect();
            const [x, y] = [box.left - whole.left, whole.bottom - box.bottom];
            const pixels = { x, y, width: box.width, height: box.height };
            for (const key in pixels) pixels[key] = Math.round(pixels[key] * ratio);
            return pixels;
        });
    }

    draw() {
        const canvas = $('canvas');
        const ratio = Math.min(2, window.devicePixelRatio || 1);
        const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.round(n * ratio));
        if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
        const theme = THEMES[document.documentElement.dataset.theme];
        this.boxes().forEach((box, side) => {
            if (!box.width) return; // hidden
            this.picture.drawSide(side, box, this.camera, this.engine.grips(side), theme, ratio);
        });
        this.stale = false;
    }

    // One animation frame.
    async tick(now) {
        if (this.busy || !this.text || now - this.last < FRAME_MS - 1) return;
        this.last = Math.max(this.last, now - 2 * FRAME_MS) + FRAME_MS;
        try {
            await this.tools.frame();
            if (this.busy) return;
            if (this.playing) this.play();
            if (this.stale) {
                this.draw();
                this.film.add(now, $('canvas'), (copy) => this.copyViews(copy));
            }
            if (!this.playing || now - this.shown < SHOW_MS) return;
            this.shown = now;
            this.show(false);
        } catch (trap) {
            await this.halt(trap);
        }
    }

    // Does something with the engines beside frames.
    async guard(work) {
        try {
            await work();
        } catch (trap) {
            await this.halt(trap);
        }
    }

    async halt(trap) {
        this.busy = true;
        this.playing = this.stale = false;
        $('pause').textContent = 'Play';
        this.say(await this.recover(trap));
        this.busy = false;
    }

    // Frames one after the other, each with all its steps, whatever time they take.
    advance(frames = 1) {
        if (this.playing) this.pause(true);
        for (let i = 0; i < frames; i++) this.step(this.stepsPerFrame());
        this.draw();
        this.show(true);
    }

    pause(paused = true) {
        this.playing = !paused;
        this.meters.forEach((meter) => meter.begin());
        this.engine.present().forEach((side) => this.engine.clearStages(side));
        $('pause').textContent = paused ? 'Play' : 'Pause';
    }

    // Shows and steps one side alone, or both (undefined), from the scene's beginning: so both are at one time.
    async showOnly(side) {
        this.engine.only = side;
        $('views').dataset.only = side ?? '';
        await this.reset();
        this.frame();
    }

    async reset() { this.say(await this.open(() => this.text, false)); }

    once() {
        this.pause(true);
        this.step(1);
        this.panel.show(this.meters);
    }

    // What a key that is neither for the camera nor for pulling does; whether it does anything.
    command(key) {
        if (key === ' ') this.pause(this.playing);
        else if (key === '.') this.once();
        else if (key === 'r') this.reset();
        else return false;
        return true;
    }

    setTheme(dark) {
        document.documentElement.dataset.theme = dark ? 'dark' : 'light';
        $('theme').setAttribute('aria-pressed', dark);
        this.changed();
        if (this.text) this.panel.show(this.meters);
    }

    // Copies both views, as they have just been drawn, onto a canvas, with names and times.
    copyViews(copy) {
        const shown = this.engine.present();
        const time = (side) => (!shown.includes(side) ? ''
            : `${this.engine.sideName(side)}, ${this.engine.figure(side, 'time').toFixed(2)} s`);
        const ink = getComputedStyle(document.body).color;
        copyWithCaptions(copy, $('canvas'), this.boxes(), [time(0), time(1)], ink);
    }

    // Both views now, as a canvas of their own.
    still() {
        this.draw();
        const { width, height } = $('canvas');
        const copy = Object.assign(document.createElement('canvas'), { width, height });
        this.copyViews(copy);
        return copy;
    }

    picturePNG() { this.still().toBlob((blob) => saveFile('shapebench.png', blob)); }
    async saveVideo() { this.say(await this.film.save()); }

    async copyLink() {
        this.fragment = `#${await packScene(this.text)}`;
        location.hash = this.fragment;
        const mesh = this.engine.given.named(this.text);
        const without = mesh && ` It does not carry the mesh: who opens it drops ${mesh} on the page then.`;
        try {
            await navigator.clipboard.writeText(location.href);
            this.say(`Link copied.${without}`);
        } catch {
            this.say(`The link is in the address bar.${without}`);
        }
    }

    // Opens the scene that the address carries, unless it is the one that was copied from here: '', or
    // why not; null where it carries none.
    async openLink() {
        if (location.hash === this.fragment || !location.hash.includes('scene=')) return null;
        const text = await unpackScene(location.hash);
        const refused = text ? await this.visit(text) : 'The link is damaged: no scene can be read from it.';
        this.say(refused);
        return refused;
    }

    // Where a vertex of the surface's points is in the canvas, in its pixels from its upper left corner.
    project(side, vertex, points = this.engine.surface(side).points) {
        const box = this.boxes()[side];
        const point = [...points.subarray(3 * vertex, 3 * vertex + 3)];
        const at = this.camera.project(point, box.width / box.height);
        return {
            x: box.x + (at.x + 1) / 2 * box.width,
            y: $('canvas').height - box.y - (at.y + 1) / 2 * box.height,
        };
    }
}
