// hands.js - pointers and keys on the views: they pull the bodies, pin them, and move the camera.
import { add } from 'view/camera';
import { pickHit, pickNear } from 'view/pick';

const PIN_REACH = 14; // pixels around a pin that take it
const MOUSE_REACH = 6; // beside a body
const TOUCH_REACH = 22;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Hands {
    constructor(app) {
        this.app = app;
        this.moved = new Map(); // of each grip: by how much it has been dragged
        this.pointers = new Map();
        this.keyHold = this.keyUse = null;
        app.views.forEach((view, side) => this.listen(view, side));
        document.addEventListener('keydown', (event) => this.key(event));
    }

    listen(view, side) {
        view.addEventListener('pointerdown', (event) => this.down(event, view, side));
        view.addEventListener('pointermove', (event) => this.move(event));
        for (const name of ['pointerup', 'pointercancel'])
            view.addEventListener(name, (event) => this.up(event));
        view.addEventListener('dblclick', (event) => this.unpin(side, event));
        view.addEventListener('contextmenu', (event) => event.preventDefault());
        view.addEventListener('wheel', (event) => {
            event.preventDefault();
            this.app.camera.zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.03 : 0.001)));
            this.app.changed();
        }, { passive: false });
    }

    // Where an event is in its view (camera.js), and the pixels of half the view's height.
    place(event, view) {
        const box = view.getBoundingClientRect();
        const x = (event.clientX - box.left) / box.width * 2 - 1;
        const y = 1 - (event.clientY - box.top) / box.height * 2;
        return { x, y, aspect: box.width / box.height, half: box.height / 2 };
    }

    pinAt(side, { x, y, aspect, half }) {
        const near = ({ point }) => {
            const at = this.app.camera.project(point, aspect);
            return Math.hypot((at.x - x) * aspect, at.y - y) * half;
        };
        return this.app.engine.grips(side).find((held) => near(held) < PIN_REACH);
    }

    // Takes hold of what is at a place: a pin that is there, else the body. Null where nothing is.
    take(side, place, limit) {
        const { engine, camera } = this.app;
        const pin = this.pinAt(side, place);
        const moved = this.moved.get(pin?.grip) ?? [0, 0, 0];
        if (pin) return { ...pin, from: add(pin.point, moved, -1), pinned: true };
        const surface = engine.surface(side);
        let vertex = pickHit(surface, camera.ray(place.x, place.y, place.aspect));
        if (vertex < 0) vertex = pickNear(surface, camera, place.aspect, place.x, place.y, limit);
        if (vertex < 0) return null;
        const from = [...surface.points.subarray(3 * vertex, 3 * vertex + 3)];
        const grip = engine.grab(side, vertex, 2 * engine.figure(side, 'cell'));
        if (grip < 0) return null;
        this.moved.set(grip, [0, 0, 0]);
        this.app.changed();
        return { grip, from, point: from, pinned: false };
    }

    drag(hold, point) {
        hold.point = point;
        this.moved.set(hold.grip, add(point, hold.from, -1));
        this.app.engine.drag(hold.grip, this.moved.get(hold.grip));
        this.app.changed();
    }

    letGo(hold, pin) {
        if (!pin) this.release(hold.grip);
        this.app.changed();
    }

    release(grip) {
        for (const pointer of this.pointers.values())
            if (pointer.hold?.grip === grip) this.spend(pointer);
        if (this.keyHold?.grip === grip) this.keyHold = null;
        this.app.engine.release(grip);
        this.moved.delete(grip);
        this.app.changed();
    }

    releaseAll() {
        this.keyHold = null;
        for (const grip of [...this.moved.keys()]) this.release(grip);
    }

    // All grips are gone: another scene is open.
    forget() {
        this.moved.clear();
        this.keyUse?.use.drop();
        this.keyHold = this.keyUse = null;
        for (const pointer of this.pointers.values()) {
            pointer.use?.drop();
            this.spend(pointer);
        }
    }

    // A pointer that has lost what it held does nothing more until it comes down again.
    spend(pointer) {
        pointer.spent ||= Boolean(pointer.use || pointer.hold);
        pointer.use = pointer.hold = null;
        pointer.view.classList.remove('pulling');
    }

    // Ends all that hands do: another tool is taken up.
    endAll() {
        this.keyUse?.use.end();
        if (this.keyHold) this.letGo(this.keyHold, this.keyHold.pinned);
        this.keyHold = this.keyUse = null;
        for (const pointer of this.pointers.values()) {
            pointer.use?.end();
            if (pointer.hold) this.letGo(pointer.hold, pointer.hold.pinned);
            this.spend(pointer);
        }
    }

    unpin(side, event) {
        const pin = this.pinAt(side, this.place(event, this.app.views[side]));
        if (pin) this.release(pin.grip);
    }

    down(event, view, side) {
        view.setPointerCapture(event.pointerId);
        const place = this.place(event, view);
        const limit = (event.pointerType === 'touch' ? TOUCH_REACH : MOUSE_REACH) / place.half;
        for (const pointer of this.pointers.values()) { // the second of two fingers: they turn the view
            pointer.use?.end();
            pointer.use = null;
        }
        const alone = ![...this.pointers.values()].some((pointer) => !pointer.hold);
        const works = event.button === 0 && alone;
        const use = works ? this.app.tools.begin(side, place) : null;
        const hold = works && !use ? this.take(side, place, limit) : null;
        const offset = hold && add(hold.point, this.onPlane(place, hold.point), -1);
        this.pointers.set(event.pointerId, { view, place, use, hold, offset, pan: event.button !== 0 });
        view.classList.toggle('pulling', hold !== null);
    }

    onPlane({ x, y, aspect }, point) { return this.app.camera.onPlane(x, y, aspect, point); }

    move(event) {
        const pointer = this.pointers.get(event.pointerId);
        if (!pointer) return;
        const before = pointer.place;
        pointer.place = this.place(event, pointer.view);
        if (pointer.spent) return;
        if (pointer.use) {
            pointer.use.move(pointer.place);
            return;
        }
        if (pointer.hold) {
            const point = this.onPlane(pointer.place, pointer.hold.point);
            this.drag(pointer.hold, add(point, pointer.offset));
            return;
        }
        const right = (pointer.place.x - before.x) * before.aspect;
        const up = pointer.place.y - before.y;
        const other = [...this.pointers.values()].find((one) => one !== pointer && !one.hold && !one.spent);
        if (other) this.pinch(pointer.place, before, other.place, right, up);
        else if (pointer.pan) this.app.camera.pan(right, up);
        else this.app.camera.orbit(1.6 * right, 1.6 * up);
        this.app.changed();
    }

    // One of two fingers has moved: half of that pans, and what it changes of their distance zooms.
    pinch(now, before, other, right, up) {
        const apart = (one) => Math.hypot((one.x - other.x) * one.aspect, one.y - other.y) || 1e-3;
        this.app.camera.pan(right / 2, up / 2);
        this.app.camera.zoom(apart(before) / apart(now));
    }

    up(event) {
        const pointer = this.pointers.get(event.pointerId);
        if (!pointer) return;
        this.pointers.delete(event.pointerId);
        pointer.view.classList.remove('pulling');
        pointer.use?.end();
        const pin = event.shiftKey || this.app.pinning();
        if (pointer.hold) this.letGo(pointer.hold, pin || pointer.hold.pinned);
    }

    key(event) {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (event.target.closest('textarea, select, input:not([type=radio], [type=checkbox])')) return;
        const own = event.key === ' ' || (event.target.type === 'radio' && ARROWS[event.key]);
        if (own && event.target.closest('button, summary, a, input')) return;
        const done = this.useKey(event) || this.pullKey(event) || this.cameraKey(event)
            || this.app.command(event.key);
        if (done) event.preventDefault();
    }

    // A line over both views, of places; of none, nothing.
    showTrail(places) {
        for (const view of this.app.views) {
            const { width, height } = view.getBoundingClientRect();
            const points = places.map(({ x, y }) => `${(x + 1) / 2 * width},${(1 - y) / 2 * height}`);
            view.querySelector('polyline').setAttribute('points', points.join(' '));
        }
    }

    // With another tool than the hand 'g' begins to use it in the middle of the view in focus.
    useKey(event) {
        const side = this.app.views.indexOf(document.activeElement);
        if (event.key === 'g' && side >= 0 && !this.keyUse && this.app.tools.name !== 'pull') {
            const box = this.app.views[side].getBoundingClientRect();
            const place = { x: 0, y: 0, aspect: box.width / box.height, half: box.height / 2 };
            const use = this.app.tools.begin(side, place);
            if (use) this.keyUse = { place, use };
            this.app.say(use ? 'Arrows move it, Enter ends.' : 'There is nothing in the middle of the view.');
            return true;
        }
        if (!this.keyUse || event.target.closest('button, summary, a')) return false;
        const { use, place } = this.keyUse;
        if (event.key === 'Enter' || event.key === 'Escape') {
            use.end();
            this.keyUse = null;
            this.app.say('');
            return true;
        }
        if (!ARROWS[event.key]) return false;
        const [right, up] = ARROWS[event.key].map((n) => 0.05 * n);
        this.keyUse.place = { ...place, x: place.x + right / place.aspect, y: place.y + up };
        use.move(this.keyUse.place);
        return true;
    }

    // 'g' takes what is nearest to the middle of the view in focus; then arrows move it.
    pullKey(event) {
        const side = this.app.views.indexOf(document.activeElement);
        if (event.key === 'g' && side >= 0 && !this.keyHold) {
            const box = this.app.views[side].getBoundingClientRect();
            const middle = { x: 0, y: 0, aspect: box.width / box.height, half: box.height / 2 };
            this.keyHold = this.take(side, middle, Infinity);
            if (this.keyHold) this.app.say(`Holding ${this.app.engine.sideName(side)}: arrows move it, Enter lets go.`);
            return true;
        }
        if (!this.keyHold || event.target.closest('button, summary, a')) return false;
        if (event.key === 'Enter' || event.key === 'Escape') {
            const pin = event.key === 'Enter' && (event.shiftKey || this.app.pinning());
            this.letGo(this.keyHold, pin || this.keyHold.pinned);
            this.keyHold = null;
            this.app.say('Let go.');
            return true;
        }
        if (!ARROWS[event.key]) return false;
        const { right, up } = this.app.camera.axes();
        const step = ARROWS[event.key].map((n) => 0.05 * n * this.app.camera.reach());
        this.drag(this.keyHold, add(add(this.keyHold.point, right, step[0]), up, step[1]));
        return true;
    }

    cameraKey(event) {
        const { camera } = this.app;
        const scrolls = document.documentElement.scrollHeight > window.innerHeight;
        const looking = !scrolls || this.app.views.includes(document.activeElement);
        const arrow = looking && ARROWS[event.key];
        if (arrow && event.shiftKey) camera.pan(-0.1 * arrow[0], -0.1 * arrow[1]);
        else if (arrow) camera.orbit(0.08 * arrow[0], 0.08 * arrow[1]);
        else if (event.key === '+' || event.key === '=') camera.zoom(0.9);
        else if (event.key === '-') camera.zoom(1 / 0.9);
        else return false;
        this.app.changed();
        return true;
    }
}
