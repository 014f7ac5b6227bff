// inside.js - the group "See inside": what of both bodies' inside is shown, and which particle's region.
import { short } from 'view/charts';
import { CELL, InsideEngine } from 'view/inside_engine';
import { InsidePicture, tones } from 'view/inside_draw';

// Pixels around the pointer in which a particle is looked for.
const REACH = { mouse: 24, pen: 24, touch: 40 };
const COVER = 5; // and in which the nearest to the eye is meant
const TOGGLES = [
    ['lattice', 'Particles and links; cells by level'],
    ['diagonals', 'Diagonal links, too', 'part'],
    ['region', 'Region under the pointer, or by key i'],
    ['rest', 'Shape at rest'],
    ['difference', 'Difference of the two surfaces'],
];
const CLEARNESS = 0.9;
const NONE = new Float32Array(0);

function make(tag, values, ...children) {
    const element = Object.assign(document.createElement(tag), values);
    element.append(...children);
    return element;
}

// 1, 2 or 5 times a power of ten, at least `least`.
function roundUp(least) {
    const power = 10 ** Math.floor(Math.log10(least));
    return power * [1, 2, 5, 10].find((digit) => digit * power >= least * 0.9999);
}

export class Inside {
    constructor(app, shaders) {
        this.app = app;
        this.data = new InsideEngine(app.engine);
        this.picture = new InsidePicture(app.picture, shaders);
        this.on = {};
        this.fresh = ['', '']; // the theme in which what is drawn is of the state now
        this.shown = [false, false];
        this.links = [-1, -1]; // as many as were put into buffers
        this.marks = [null, null];
        this.most = 0; // the difference's scale, cells,
        this.far = [0, 0]; // and how far it goes on each side
        const group = document.getElementById('inside');
        for (const [name, words, kind] of TOGGLES) group.append(this.toggle(name, words, kind));
        group.append(this.note = make('p', { className: 'note' }));
        this.legends = app.views.map((view) => view.appendChild(make('div', { className: 'legend' })));
        this.lines = app.views.map((view) =>
            view.appendChild(make('p', { className: 'marked', role: 'status' })));
        app.views.forEach((view, side) => this.listen(view, side));
        document.addEventListener('keydown', (event) => this.key(event));
    }

    toggle(name, words, kind = '') {
        const box = make('input', { type: 'checkbox', id: `inside-${name}` });
        box.addEventListener('change', () => this.set(name, box.checked));
        return make('label', { className: kind, htmlFor: box.id }, box, words);
    }

    set(name, shown) {
        this.on[name] = shown;
        if (name === 'diagonals' && shown && !this.on.lattice) this.click('lattice');
        if (name === 'region' && !shown) this.forget();
        if (name === 'difference') this.most = 0;
        this.again();
    }

    click(name) { document.getElementById(`inside-${name}`).click(); }

    again() {
        this.fresh = ['', ''];
        this.app.changed();
    }

    forget() {
        this.marks = [null, null];
        this.lines.forEach((line) => { line.textContent = ''; });
    }

    // The body of a side has moved, or is another one.
    moved(side) { this.fresh[side] = ''; }

    // Another scene is open, or another lattice.
    opened() {
        this.links = [-1, -1];
        this.most = 0;
        this.forget();
        this.again();
    }

    // ---- which particle

    listen(view, side) {
        const pick = (event) => {
            if (!this.on.region) return;
            const place = this.app.hands.place(event, view);
            this.pick(side, place, REACH[event.pointerType] ?? REACH.mouse);
        };
        view.addEventListener('pointermove', (event) => { if (!event.buttons) pick(event); });
        view.addEventListener('pointerdown', (event) => { if (event.pointerType !== 'mouse') pick(event); });
    }

    // 'i' takes what is nearest to the middle of the view in focus.
    key(event) {
        const side = this.app.views.indexOf(document.activeElement);
        if (event.key !== 'i' || side < 0 || event.ctrlKey || event.metaKey || event.altKey) return;
        const box = this.app.views[side].getBoundingClientRect();
        if (!this.on.region) this.click('region');
        this.pick(side, { x: 0, y: 0, aspect: box.width / box.height, half: box.height / 2 }, Infinity);
    }

    // Marks the particle that is seen nearest to a place of the view, at most `reach` pixels from it; of
    // those that the pointer covers the one nearest to the eye.
    pick(side, { x, y, aspect, half }, reach) {
        if (this.app.engine.absent(side)) return;
        const points = this.data.points(side);
        const m = this.app.camera.matrix(aspect);
        let [found, least, nearest] = [-1, reach, Infinity];
        for (let p = 0; p < points.length / 3; p++) {
            const [px, py, pz] = [points[3 * p], points[3 * p + 1], points[3 * p + 2]];
            const w = m[3] * px + m[7] * py + m[11] * pz + m[15];
            const across = (m[0] * px + m[4] * py + m[8] * pz + m[12]) / w - x;
            const along = (m[1] * px + m[5] * py + m[9] * pz + m[13]) / w - y;
            const off = Math.max(COVER, Math.hypot(across * aspect, along) * half);
            if (w <= 0 || off > least || (off === least && w >= nearest)) continue;
            [found, least, nearest] = [p, off, w];
        }
        if (found < 0 || found === this.marks[side]?.particle) return;
        this.marks[side] = { particle: found, particles: points.length / 3 };
        this.again();
    }

    // ---- what is drawn

    get clear() { return this.on.lattice || this.on.region; }

    // What is shown of a side, of its state now.
    refresh(side, theme) {
        if (this.fresh[side] === theme.name) return;
        this.fresh[side] = theme.name;
        const { data, on, picture } = this;
        if (on.lattice || on.region) picture.setPoints(side, data.points(side));
        if (on.lattice && side === 0 && data.linkCount(side) !== this.links[side]) {
            this.links[side] = data.linkCount(side);
            picture.setLinks(side, data.links(side));
        }
        if (on.lattice && side === 1) this.levels = this.setCells(side);
        if (on.rest) {
            const { indices } = this.app.engine.surface(side);
            picture.setGhost(side, { ...data.rest(side), indices });
        }
        this.compare(side);
        this.showMark(side, theme);
        this.showLegend(side, theme);
    }

    // Cells of each level.
    setCells(side) {
        const cells = this.data.cells(side);
        const count = [];
        for (let i = CELL - 1; i < cells.length; i += CELL) count[cells[i]] = (count[cells[i]] ?? 0) + 1;
        this.picture.setCells(side, cells);
        return count;
    }

    compare(side) {
        const why = this.on.difference ? this.data.notComparable() : '';
        const apart = this.on.difference && !why ? this.data.difference(side) : NONE;
        this.note.textContent = why;
        this.picture.setApart(side, apart);
        this.far[side] = apart.reduce((far, cells) => Math.max(far, cells), 0);
        const far = Math.max(...this.far); // of both sides: they have one scale
        if (!apart.length) this.most = 0;
        else if (far > this.most || far < 0.2 * this.most) this.most = roundUp(Math.max(far, 1e-6));
    }

    showMark(side, theme) {
        const was = this.marks[side];
        if (!was) return;
        const particles = this.app.engine.figure(side, 'particles'); // others: numbers mean others, too
        const mark = was.particles === particles ? this.data.mark(side, was.particle) : null;
        this.marks[side] = mark && { ...mark, particles };
        const words = mark ? this.describe(side, mark) : '';
        if (this.lines[side].textContent !== words) this.lines[side].textContent = words;
        if (mark) this.picture.setMark(side, mark, this.data.points(side), theme);
    }

    describe(side, mark) {
        if (this.app.engine.kind(side) === 'meshless')
            return `Node ${mark.particle}: it moves what is in its cover, where ${mark.count} nodes stand`;
        if (this.app.engine.kind(side) === 'shell')
            return `Node ${mark.particle}: ${mark.count} nodes move the surface where it stands`;
        const [one, many] = side ? ['Node', 'nodes'] : ['Particle', 'particles'];
        let sums = `${mark.bars} bars in ${mark.plates} plates`;
        if (mark.nodes) sums = `${mark.nodes} summation nodes`;
        else if (!mark.bars) sums = 'each by itself';
        return `${one} ${mark.particle}: a region of ${mark.count} ${many}, summed as ${sums}; `
            + `its goal is ${short(mark.goalCells)} cells away`;
    }

    showLegend(side, theme) {
        const rows = [];
        const levels = side === 1 && this.on.lattice ? this.levels : [];
        levels.forEach((count, level) => {
            const row = make('span', { className: 'level', textContent: `level ${level}: ${count} cells` });
            row.style.setProperty('--tone', tones(theme).levels[Math.min(7, level)]);
            rows.push(row);
        });
        if (this.most) {
            const [none, most] = ['0', `${short(this.most)} cells`]
                .map((textContent) => make('span', { textContent }));
            rows.push(make('span', { textContent: `Distance from ${this.app.engine.sideName(1 - side)}` }),
                make('div', { className: 'ramp' }), make('div', { className: 'scale' }, none, most));
        }
        const key = `${theme.name} ${rows.map((row) => row.textContent)}`; // frames that change nothing
        if (this.legends[side].dataset.key === key) return;
        this.legends[side].dataset.key = key;
        this.legends[side].replaceChildren(...rows);
    }

    // Before all that is translucent. Whether the body is no longer to be drawn.
    drawBefore(side, scene) {
        const any = Object.values(this.on).includes(true);
        if (!any && !this.shown[side] || this.app.engine.absent(side)) return false;
        this.shown[side] = any; // once more after the last toggle is off, to clear what was shown
        this.refresh(side, scene.theme);
        scene.cell = this.app.engine.figure(side, 'cell');
        if (this.on.lattice && side === 0) this.picture.drawLattice(side, scene, this.on.diagonals);
        if (this.on.lattice && side === 1) this.picture.drawCells(side, scene);
        if (!this.clear && this.most) this.app.picture.drawBody(side, scene, { most: this.most });
        return this.clear || this.most > 0;
    }

    drawAfter(side, scene) {
        if (!this.shown[side] || this.app.engine.absent(side)) return;
        const { picture } = this;
        const body = (as) => this.app.picture.drawBody(side, scene, { most: this.most, ...as });
        if (this.clear) picture.drawGlass(body, this.most ? 0.5 : CLEARNESS);
        if (this.on.rest) picture.drawGhost(side, scene);
        if (this.marks[side]) picture.drawMark(side, scene);
    }
}
