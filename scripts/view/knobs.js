// knobs.js - what the page's knobs are: each changes one setting of the scene's text.
import {
    asReal, getNumber, getNumbers, getSetting, getString, removeSetting, setSetting,
} from 'view/scene_text';

// Where an octree's cells are split, as settings of its scene. The body stands on y = 0 in most.
const SPLITS = {
    'where parts are near': () => ({}),
    'at the surface': () => ({ criteria: '( { kind = "surface"; } )' }),
    'all alike': () => ({ criteria: '( { kind = "uniform"; } )' }),
    'near its top': ({ low, high }) => {
        const centre = [(low[0] + high[0]) / 2, high[1], (low[2] + high[2]) / 2].map(asReal).join(', ');
        const radius = asReal(0.35 * Math.max(...high.map((x, d) => x - low[d])));
        return { criteria: `( { kind = "sphere"; centre = [${centre}]; radius = ${radius}; } )` };
    },
    'near this view': ({ low, high }, camera) => {
        const eye = camera.eye().map(asReal).join(', ');
        const size = Math.hypot(...high.map((x, d) => x - low[d]));
        const near = asReal(Math.max(0.1 * size, camera.distance - 0.1 * size));
        const places = `eye_from = [${eye}]; eye_to = [${eye}]; near = ${near}`;
        return { view: `{ ${places}; slack = 0.2; level = 12; }` };
    },
};
const AS_IN_FILE = 'as the file says';

function getSplits(text) {
    const criteria = getSetting(text, 'octree.criteria');
    if (getSetting(text, 'view')) return 'near this view';
    if (!criteria) return 'where parts are near';
    const kinds = [...criteria.matchAll(/kind *= *"(\w+)"/g)].map((match) => match[1]).join(' ');
    const name = {
        features: 'where parts are near', surface: 'at the surface',
        uniform: 'all alike', sphere: 'near its top',
    }[kinds];
    return name ?? AS_IN_FILE;
}

function setSplits(text, value, app) {
    if (value === AS_IN_FILE) return text;
    const { criteria, view } = SPLITS[value](app.engine.bounds(), app.camera);
    const bare = removeSetting(removeSetting(text, 'octree.criteria'), 'view');
    if (view) return setSetting(bare, 'view', view);
    return criteria ? setSetting(bare, 'octree.criteria', criteria) : bare;
}

// Regions in the upper half of the body, wider or narrower than elsewhere: stiffer or softer.
function setUpper(text, value, app) {
    const { low, high } = app.engine.bounds();
    const far = asReal(100 * Math.max(...high.map((x, d) => x - low[d])));
    const middle = asReal((low[1] + high[1]) / 2);
    const box = `low = [-${far}, ${middle}, -${far}]; high = [${far}, ${far}, ${far}]`;
    return setSetting(text, 'octree.widths', `( { ${box}; edges = ${value}; } )`);
}

function getUpper(text) {
    const edges = /edges *= *([\d.]+)/.exec(getSetting(text, 'octree.widths') ?? '');
    return edges ? Number(edges[1]) : undefined;
}

// What is beside FastLSM: 'octree', unless the scene is of another engine.
function getBeside(text) {
    const engine = getString(text, 'engine') ?? 'fastlsm';
    return engine === 'fastlsm' ? 'octree' : engine;
}

// What a shell does not take of a scene.
const NOT_OF_SHELLS = ['bend', 'twist', 'squash', 'kick', 'cuts', 'planes', 'spheres', 'boxes', 'capsules'];

// A shell that nothing holds is held at its foot, as `shapebench run MESH --engine shell` has it: no ground
// stops it. A mesh of one's own stands for a body a metre tall.
function setBeside(text, value, app) {
    if (value !== 'shell') {
        const engine = getString(app.original ?? '', 'engine');
        return setSetting(text, 'engine', engine === value ? `"${value}"` : '"fastlsm"');
    }
    let held = setSetting(NOT_OF_SHELLS.reduce(removeSetting, text), 'engine', '"shell"');
    if (!getSetting(held, 'handles')) held = setSetting(held, 'handles', '( { box_high = [1.0, 0.1, 1.0]; } )');
    const { low, high } = app.engine.bounds();
    const own = !(getString(held, 'mesh') ?? '').startsWith('shape:');
    return own && !getSetting(held, 'meshless.metre')
        ? setSetting(held, 'meshless.metre', asReal(high[1] - low[1])) : held;
}

const longest = (app) => {
    const { low, high } = app.engine.bounds();
    return Math.max(...high.map((x, d) => x - low[d]));
};
const UNBROKEN = 1e8; // Pa: the end of a slider

// Sliders: those that are `first` are seen at once; `log` ones move by powers of ten; those of an `engine`, or of
// several, are there where that is. `get` and `set` where it is not the plain setting `key`.
export const SLIDERS = [
    { key: 'w', first: true, label: 'w, half-width of regions', least: 1, most: 8, by: 1, whole: true, start: 2 },
    { key: 'epsilon', first: true, engine: 'octree', label: 'Octree: epsilon', least: 0, most: 2, by: 0.05,
        start: 0.5 },
    { key: 'damping', first: true, label: 'Damping', least: 0, most: 1, by: 0.01, start: 0 },
    { key: 'h', first: true, label: 'Time step h, s (shorter: stiffer)', least: 0.001, most: 0.03, log: true,
        start: 0.01 },
    { key: 'particles', label: 'Particles wanted', least: 100, most: 60000, log: true, whole: true,
        set: (text, value) => {
            const without = removeSetting(removeSetting(text, 'cells'), 'cell');
            return setSetting(without, 'particles', value);
        } },
    { key: 'gravity', label: 'Gravity in y', least: -19.62, most: 9.81, by: 0.981, start: 0, open: true,
        choices: [0, -9.81],
        get: (text) => getNumbers(text, 'gravity')?.[1],
        set: (text, value) => {
            const [x, , z] = getNumbers(text, 'gravity') ?? [0, 0, 0];
            return setSetting(text, 'gravity', `[${asReal(x)}, ${value}, ${asReal(z)}]`);
        } },
    { key: 'meshless.young', first: true, engine: ['meshless', 'shell'], label: 'Elastic: Young\u2019s modulus, Pa',
        least: 1e4, most: 1e8, log: true, start: 1e5 },
    { key: 'meshless.thickness', engine: 'shell', label: 'Shell: thickness, share of its length', least: 0.001,
        most: 0.05, log: true, start: 0.01,
        get: (text, app) => getNumber(text, 'meshless.thickness') / longest(app) || undefined,
        set: (text, value, app) => setSetting(text, 'meshless.thickness', asReal(value * longest(app))) },
    { key: 'meshless.nodes', engine: 'shell', label: 'Shell: nodes wanted', least: 50, most: 2000, log: true,
        whole: true, start: 450 },
    { key: 'meshless.strength', engine: 'shell', label: 'Shell: it cracks from this stress on, Pa', least: 1e3,
        most: UNBROKEN, log: true, hint: 'never', otherwise: UNBROKEN,
        set: (text, value) => (value < UNBROKEN ? setSetting(text, 'meshless.strength', value)
            : removeSetting(text, 'meshless.strength')) },
    { key: 'octree.levels', engine: 'octree', label: 'Octree: levels', least: 1, most: 6, by: 1, whole: true,
        hint: 'not set: up to 4', otherwise: 4 },
    { key: 'octree.widths', engine: 'octree', label: 'Octree: w of the upper half, edges', least: 0.25, most: 4, by: 0.25,
        hint: 'as below', otherwise: 1, set: setUpper,
        get: getUpper },
];
export const CHOICES = [
    { key: 'octree.weighting', engine: 'octree', label: 'Octree: weighting', of: ['conserving', 'plain'] },
    { key: 'octree.criteria', engine: 'octree', label: 'Octree: cells split', of: Object.keys(SPLITS),
        get: getSplits, set: setSplits },
    { key: 'summation', label: 'Summation', of: ['fast', 'bars', 'naive'] },
    { key: 'polar', label: 'Polar', of: ['fast', 'jacobi'] },
    { key: 'engine', label: 'Beside FastLSM', of: ['octree', 'shell'], get: getBeside, set: setBeside },
];
