// scene_text.js - reads and changes single settings in a scene file's text (libconfig's syntax), and
// leaves all else in it, comments too, as it is.

// Past the blanks and comments that begin at `at`.
function skipBlanks(text, at) {
    const blanks = /(?:\s+|#[^\n]*|\/\/[^\n]*|\/\*[\s\S]*?\*\/)*/y;
    blanks.lastIndex = at;
    blanks.exec(text);
    return blanks.lastIndex;
}

// Past what `pattern` (sticky) matches at `at`; `at` itself where it does not match.
function skipMatch(text, at, pattern) {
    pattern.lastIndex = at;
    return pattern.test(text) ? pattern.lastIndex : at;
}

const STRING = /"(?:\\.|[^"\\])*"/y;
const WORD = /[^\s;,#/(){}[\]"]+/y;

// Past the bracket that closes the one at `at`, or the text's end.
function skipBracket(text, at) {
    let depth = 0;
    do {
        at = skipBlanks(text, at);
        if ('([{'.includes(text[at])) depth++;
        if (')]}'.includes(text[at])) depth--;
        at = text[at] === '"' ? Math.max(skipMatch(text, at, STRING), at + 1) : at + 1;
    } while (depth > 0 && at < text.length);
    return at;
}

// Past the value at `at`: a bracket, strings one after the other, or a word.
function skipValue(text, at) {
    if ('([{'.includes(text[at])) return skipBracket(text, at);
    let end = skipMatch(text, at, STRING);
    if (end === at) return skipMatch(text, at, WORD);
    for (;;) {
        const next = skipBlanks(text, end);
        const past = skipMatch(text, next, STRING);
        if (past === next) return end;
        end = past;
    }
}

// The setting `name` among those from `at` on to `end`: where it starts, its value's range, and past
// its terminator. Text that is no setting ends the search.
function findAmong(text, name, at, end) {
    for (at = skipBlanks(text, at); at < end; at = skipBlanks(text, at)) {
        const start = at;
        at = skipMatch(text, at, /[A-Za-z*][-\w*]*/y);
        const found = text.slice(start, at);
        at = skipBlanks(text, at);
        if (!found || (text[at] !== '=' && text[at] !== ':')) return null;
        const from = skipBlanks(text, at + 1);
        const to = skipValue(text, from);
        if (to === from) return null;
        const mark = skipBlanks(text, to);
        at = text[mark] === ';' || text[mark] === ',' ? mark + 1 : to;
        if (found === name) return { start, from, to, past: at };
    }
    return null;
}

function find(text, path) {
    let place = { from: -1, to: text.length + 1 };
    for (const name of path.split('.')) {
        place = findAmong(text, name, place.from + 1, place.to - 1);
        if (!place) return null;
    }
    return place;
}

// The text of the value of `path`, such as 'w' or 'octree.levels'; undefined where it is not set.
export function getSetting(text, path) {
    const place = find(text, path);
    return place ? text.slice(place.from, place.to) : undefined;
}

export function getNumber(text, path) {
    const value = Number(getSetting(text, path));
    return Number.isFinite(value) ? value : undefined;
}

// The numbers of an array or list such as `[0.0, -9.81, 0.0]`; undefined where it is not set.
export function getNumbers(text, path) {
    const value = getSetting(text, path);
    if (!value || !/^[[(]/.test(value)) return undefined;
    const bare = value.slice(1, -1).replace(/#[^\n]*|\/\/[^\n]*|\/\*[\s\S]*?\*\//g, '');
    return bare.split(',').map(Number);
}

// The text of a string setting without its quotes.
export function getString(text, path) {
    const value = getSetting(text, path);
    if (!value) return undefined;
    return value.replace(/"\s*"/g, '').replace(/^"|"$/g, '').replace(/\\(.)/g, '$1');
}

// The text with `path` set to the text `value`.
export function setSetting(text, path, value) {
    const place = find(text, path);
    if (place) return text.slice(0, place.from) + value + text.slice(place.to);
    const [name, member] = path.split('.');
    if (!member) return `${text}${/\n$|^$/.test(text) ? '' : '\n'}${name} = ${value};\n`;
    const group = find(text, name);
    if (!group) return setSetting(text, name, `{ ${member} = ${value}; }`);
    const inside = group.from + 1;
    const onLines = /^[ \t]*\n/.test(text.slice(inside));
    return `${text.slice(0, inside)}${onLines ? '\n    ' : ' '}${member} = ${value};${text.slice(inside)}`;
}

// The text without `path`; its line goes where nothing else stood on it.
export function removeSetting(text, path) {
    const place = find(text, path);
    if (!place) return text;
    const before = text.slice(0, place.start);
    const after = text.slice(place.past);
    const alone = /(^|\n)[ \t]*$/.test(before) && /^[ \t]*\n/.test(after);
    return alone ? before.replace(/[ \t]*$/, '') + after.replace(/^[ \t]*\n/, '') : before + after;
}

// A number as libconfig takes it for a real: with a point.
export function asReal(value) {
    const text = String(Number(Number(value).toPrecision(6)));
    return /[.e]/.test(text) ? text : `${text}.0`;
}
