// panel.js - the knobs' elements and the figures.
import { STAGES } from 'view/engine';
import { CHOICES, SLIDERS } from 'view/knobs';
import { asReal, getNumber, getSetting, getString, setSetting } from 'view/scene_text';
import { drawLines, setBar, short } from 'view/charts';

const WAIT = 180; // ms after the last move of a knob
const round2 = (value) => Number(value.toPrecision(2));

const FIGURES = [
    ['ms a step, in this browser', (m) => m.stepMs],
    ['ms a frame: its steps, surface', (m) => m.frameMs],
    ['Particles', 'particles'], ['Regions', 'regions'], ['Links', 'links', ['fastlsm']],
    ['Summation nodes a region', 'summationNodes', ['octree']], ['Contacts', 'contacts', ['fastlsm', 'octree']],
    ['Pieces', 'pieces', ['shell']], ['Time simulated, s', 'time'], ['Speed, of real time', (m) => m.pace],
    ['Kinetic energy, J', 'kinetic'], ['Momentum, kg·m/s', 'momentum'],
];

function make(tag, values, ...children) {
    const element = Object.assign(document.createElement(tag), values);
    element.append(...children);
    return element;
}

class Knob {
    constructor(panel, what, input, extra = []) {
        Object.assign(this, { panel, what, input });
        const id = `knob-${what.key.replace('.', '-')}`;
        this.output = make('output', { htmlFor: id });
        this.note = make('p', { className: 'note', id: `${id}-note` });
        this.note.setAttribute('role', 'alert');
        input.id = id;
        input.setAttribute('aria-describedby', this.note.id);
        const label = make('label', { htmlFor: id, textContent: what.label });
        this.element = make('div', { className: 'knob' }, label, ...extra, this.output, input, this.note);
        input.addEventListener('input', () => this.moved());
    }

    moved() {
        this.output.textContent = this.value();
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.apply(), WAIT);
    }

    // Where the scene's text is refused, the knob goes back, and says why.
    async apply() {
        const { key, set = (text, value) => setSetting(text, key, value) } = this.what;
        const refused = await this.panel.change((text) => set(text, this.value(), this.panel.app));
        this.note.textContent = this.note.title = refused;
        this.fill(this.panel.text);
    }
}

class Slider extends Knob {
    constructor(panel, what) {
        const [least, most] = [what.least, what.most].map((x) => (what.log ? Math.log10(x) : x));
        const input = make('input', { type: 'range', min: least, max: most, step: what.by ?? 0.005 });
        const buttons = (what.choices ?? []).map((value) =>
            make('button', { textContent: value, ariaLabel: `${what.label}: ${value}` }));
        super(panel, what, input, buttons);
        buttons.forEach((button) => button.addEventListener('click', () => {
            input.value = button.textContent;
            this.apply();
        }));
    }

    value() {
        const { log, whole } = this.what;
        const value = log ? round2(10 ** this.input.value) : Number(this.input.value);
        return whole ? String(Math.round(value)) : asReal(value);
    }

    fill(text) {
        const { get = (all) => getNumber(all, this.what.key), start, log, hint, otherwise } = this.what;
        const given = get(text, this.panel.app);
        const value = given ?? start ?? (hint ? otherwise : this.panel.particles());
        if (this.what.open) { // bodies of other units want other values
            const { least, most, by } = this.what;
            const times = Math.max(1, 2 * value / (value < 0 ? least : most));
            Object.assign(this.input, { min: times * least, max: times * most, step: times * by });
        }
        this.input.value = log ? Math.log10(value) : value;
        this.output.textContent = given === undefined && hint ? hint : short(value);
        this.input.setAttribute('aria-valuetext', this.output.textContent);
    }
}

class Choice extends Knob {
    constructor(panel, what) {
        super(panel, what, make('select', {}, ...what.of.map((value) => new Option(value))));
        this.output.remove();
    }

    value() { return this.what.set ? this.input.value : `"${this.input.value}"`; }

    fill(text) {
        const { get = (all) => getString(all, this.what.key) ?? this.what.of[0], of } = this.what;
        const value = get(text, this.panel.app);
        const names = [...this.input.options].map((option) => option.value);
        if (!names.includes(value)) this.input.add(new Option(value));
        if (of.includes(value)) [...this.input.options].slice(of.length).forEach((option) => option.remove());
        this.input.value = value;
    }
}

export class Panel {
    // `app.open(text, keep)` resolves to '' or to why the text is refused.
    constructor(app) {
        this.app = app;
        const choices = CHOICES.map((what) => new Choice(this, what));
        this.knobs = [...SLIDERS.map((what) => new Slider(this, what)), ...choices];
        for (const knob of this.knobs)
            document.getElementById(knob.what.first ? 'knobs' : 'more-knobs').append(knob.element);
        this.rows = FIGURES.map(([label]) => this.row('figures', label));
        this.bars = STAGES.map((name) => this.row('stages', name));
        this.box = document.getElementById('text');
        this.refusal = document.getElementById('refusal');
        document.getElementById('apply').addEventListener('click', async () => {
            this.refusal.textContent = await this.change(this.box.value);
        });
    }

    get text() { return this.app.text; }

    // Opens what `change` makes of the text, or a text; motion goes on. '' or why it is refused.
    change(change) {
        return this.app.open(typeof change === 'function' ? () => change(this.text) : change, true);
    }

    // What knobs were about to change was another scene's.
    forget() { this.knobs.forEach((knob) => clearTimeout(knob.timer)); }

    particles() { return this.app.engine.figure(this.app.engine.present()[0], 'particles'); }

    row(table, label) {
        const cells = [make('td'), make('td')];
        const head = make('th', { scope: 'row', textContent: label });
        document.querySelector(`#${table} tbody`).append(make('tr', {}, head, ...cells));
        return cells;
    }

    // Shows what the text says.
    fill() {
        const kinds = [0, 1].map((side) => this.app.engine.kind(side));
        for (const knob of this.knobs) {
            const { engine = kinds } = knob.what;
            knob.element.hidden = !kinds.some((kind) => engine.includes(kind));
            knob.fill(this.text);
        }
        if (document.activeElement !== this.box) this.box.value = this.text;
        this.refusal.textContent = '';
        const title = getString(this.text, 'title') ?? getSetting(this.text, 'mesh');
        document.getElementById('title').textContent = title;
    }

    // The figures now, and the lines up to now.
    show(meters) {
        const shown = this.app.engine.present();
        FIGURES.forEach(([, what, only], row) => meters.forEach((meter, side) => {
            const value = typeof what === 'string' ? this.app.engine.figure(side, what) : what(meter);
            const has = shown.includes(side) && (!only || only.includes(this.app.engine.kind(side)));
            this.rows[row][side].textContent = has ? short(value) : '–';
        }));
        this.bars.forEach((cells, stage) => meters.forEach((meter, side) => {
            const name = this.app.engine.stageName(side, stage);
            const of = name === STAGES[stage] ? '' : `, ${name}`;
            const share = name ? meter.shares[stage] : NaN;
            setBar(cells[side], share, of, this.app.engine.paperPercent(side, stage));
        }));
        for (const key of ['kinetic', 'momentum']) drawLines(document.getElementById(key), meters, key);
    }
}
