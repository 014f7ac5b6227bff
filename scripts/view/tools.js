// tools.js - what pointers do on a body beside pulling it: cut it with a stroke, touch it, blow at it.
// A use of a tool is { move(place), end(), drop() }: the last where what it was used on is there no more.
// Places are camera.js's, of a view.
import { add, dot } from 'view/camera';
import { pickHit } from 'view/pick';

const GALE = 8; // of the wind: how often its acceleration crosses half a view in a second squared
const FINGER = 3; // radius, finest cells
const START = 0.02; // half heights that a stroke must go before it cuts

const MINCED = 'It has been cut into so much that another cut would take seconds: Reset makes it whole.';
const WHOLE = {
    meshless: 'FastLSM alone is cut: the elastic body moves by the modes of the whole.',
    shell: 'FastLSM alone is cut: a shell cracks where its stress is above its strength.',
};
const REFUSALS = {
    cut: 'Only a body that is alone can be cut: open a scene of one body, such as the liver.',
    touch: 'There is no octree here that could be refined where it is touched.',
};

export class Tools {
    constructor(app) {
        this.app = app;
        this.name = 'pull';
        this.work = null; // what waits for the next frame
        this.refused = null; // the scene's text whose bodies cannot be cut
    }

    // Takes a tool up; bodies that are not made to be cut are made anew, and go on where they are.
    async choose(name) {
        if (name !== this.name) this.app.hands.endAll();
        this.name = name;
        if (name === 'cut' && this.app.text) await this.allowCut();
        const whole = WHOLE[this.app.engine.kind(1)];
        if (name === 'cut' && whole) this.app.say(whole);
    }

    // Another scene is open: of an elastic body and of a shell nothing gets finer by a touch.
    opened() {
        const [pull, touch] = ['pull', 'touch'].map((name) => document.querySelector(`#tools [value=${name}]`));
        touch.disabled = this.app.engine.kind(1) !== 'octree';
        if (!touch.disabled || this.name !== 'touch') return;
        pull.checked = true;
        this.choose('pull');
    }

    async allowCut() {
        const { app } = this;
        const may = () => app.engine.present().some((side) => app.engine.mayCut(side));
        if (may()) return;
        if (app.text !== this.refused) {
            app.engine.allowCut();
            const why = await app.open(() => app.text, true);
            this.refused = may() ? null : app.text;
            if (!why && may()) return;
        }
        app.say(REFUSALS.cut);
    }

    // Begins to use the tool at a place of a side's view; null where there is nothing to do.
    begin(side, place) {
        const { engine, camera } = this.app;
        if (this.name === 'cut' && this.refused === this.app.text) {
            this.app.say(REFUSALS.cut);
            return null;
        }
        const hits = () => pickHit(engine.surface(side), camera.ray(place.x, place.y, place.aspect)) >= 0;
        const use = { cut: Blade, touch: Finger, wind: Wind }[this.name];
        return use && (use !== Finger || hits()) ? new use(this.app, side, place) : null;
    }

    // What is asked for several times in a frame is done once, before the frame.
    later(work) {
        this.work = work;
        this.app.changed();
    }

    async frame() {
        const { work } = this;
        this.work = null;
        await work?.();
    }
}

// A segment along the line of sight, through all that is drawn.
class Blade {
    constructor(app, side, place) {
        Object.assign(this, { app, trail: [], waiting: [] });
        this.ready = app.tools.allowCut(); // after a reset they must be made so again
        this.move(place);
    }

    // From before the nearest to behind the farthest of what both sides draw.
    segment({ x, y, aspect }) {
        const { engine, camera } = this.app;
        const { origin, direction } = camera.ray(x, y, aspect);
        const ahead = camera.axes().back.map((b) => -b);
        let [near, far] = [Infinity, -Infinity];
        for (const side of engine.present()) {
            const { points } = engine.surface(side);
            for (let i = 0; i < points.length; i += 3) {
                const depth = ahead[0] * (points[i] - origin[0]) + ahead[1] * (points[i + 1] - origin[1])
                    + ahead[2] * (points[i + 2] - origin[2]);
                if (depth < near) near = depth;
                if (depth > far) far = depth;
            }
        }
        const cell = engine.figure(engine.present()[0], 'cell');
        const along = (depth) => add(origin, direction, depth / dot(direction, ahead));
        return [along(near - cell), along(far + cell)];
    }

    // A finger that has hardly moved may yet be one of two, which turn the view.
    move(place) {
        if (this.ended) return;
        this.trail.push(place);
        this.waiting.push(place);
        this.app.hands.showTrail(this.trail);
        const far = ({ x, y }) => Math.hypot((x - this.trail[0].x) * place.aspect, y - this.trail[0].y);
        if (this.begun ||= far(place) > START) this.app.tools.later(() => this.cut());
    }

    // Along the trail as it was since the last frame: its corners, of a hand that is fast.
    async cut() {
        await this.ready;
        const { engine } = this.app;
        const may = this.waiting.splice(0).every((place) => engine.cut(...this.segment(place)));
        if (!may) this.app.say(engine.present().some((side) => engine.mayCut(side)) ? MINCED : REFUSALS.cut);
        this.app.showSurfaces();
    }

    end() {
        if (this.ended) return;
        this.ended = true;
        this.app.hands.showTrail([]);
        this.app.guard(async () => {
            if (this.begun) await this.cut();
            this.app.engine.lift();
        });
    }

    // The scene is another one.
    drop() {
        this.ended = true;
        this.waiting = [];
        this.app.hands.showTrail([]);
    }
}

// The octree is refined where it is touched; a body that shares its cells with others gets its own.
class Finger {
    constructor(app, side, place) {
        Object.assign(this, { app, side });
        this.move(place);
    }

    move(place) {
        this.app.tools.later(() => this.touch(place));
    }

    async touch(place) {
        const { app, side } = this;
        const { engine } = app;
        const pick = () => pickHit(engine.surface(side), app.camera.ray(place.x, place.y, place.aspect));
        const body = engine.body(side, pick());
        if (body < 0 || this.ended) return engine.leave();
        if (!engine.mayTouch(1, body)) {
            if (this.refused) return undefined;
            engine.allowTouch(body);
            const why = await app.open(() => app.text, true);
            this.refused = !engine.mayTouch(1, body);
            app.say(why || (this.refused ? REFUSALS.touch : ''));
        }
        if (!this.ended) engine.touch(side, pick(), FINGER * engine.figure(side, 'cell'));
        return undefined;
    }

    end() {
        this.ended = true;
        this.app.engine.leave();
    }

    drop() { this.ended = true; }
}

// Blows the way that the pointer has gone, the harder the farther.
class Wind {
    constructor(app, side, place) { Object.assign(this, { app, from: place }); }

    move(place) {
        const { camera, engine, hands } = this.app;
        const { right, up } = camera.axes();
        const strength = GALE * camera.reach();
        const across = (place.x - this.from.x) * place.aspect;
        engine.blow(add(right.map((r) => r * across * strength), up, (place.y - this.from.y) * strength));
        hands.showTrail([this.from, place]);
    }

    end() {
        this.app.engine.blow([0, 0, 0]);
        this.app.hands.showTrail([]);
    }

    drop() { this.end(); }
}
