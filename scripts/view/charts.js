// charts.js - lines over the last ten seconds, and bars of shares.
const SECONDS = 10;

// Three digits of a number, as people write it.
export function short(value) {
    if (!Number.isFinite(value)) return '–';
    const size = Math.abs(value);
    if (size >= 1000 && size < 1e7) return Math.round(value).toLocaleString('en').replaceAll(',', '\u202f');
    if (size !== 0 && (size < 0.001 || size >= 1e7))
        return value.toExponential(1).replace(/e\+?(-?\d+)$/, (all, power) => `·10${raise(power)}`);
    return String(Number(value.toPrecision(3)));
}

const RAISED = '⁻⁰¹²³⁴⁵⁶⁷⁸⁹';
const raise = (power) => power.replace(/./g, (digit) => RAISED['-0123456789'.indexOf(digit)]);

// A line for each side of what `key` was, on one scale from 0 to the highest that is seen.
export function drawLines(canvas, meters, key) {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext('2d');
    const style = getComputedStyle(canvas);
    pen.scale(ratio, ratio);
    const end = Math.max(0, ...meters.map(({ trace }) => trace.at(-1)?.time ?? 0));
    const values = meters.flatMap(({ trace }) => trace.map((one) => one[key]));
    const top = Math.max(0, ...values.filter(Number.isFinite));
    pen.strokeStyle = style.getPropertyValue('--line');
    pen.strokeRect(0.5, 0.5, width - 1, height - 1);
    meters.forEach(({ trace }, side) => {
        pen.beginPath();
        pen.strokeStyle = style.getPropertyValue(['--lattice', '--octree'][side]);
        pen.lineWidth = 1.6;
        pen.setLineDash(side ? [5, 2] : []); // told apart without colour, too
        for (const { time, [key]: value } of trace)
            pen.lineTo(width * (1 - (end - time) / SECONDS), height - 3 - (height - 18) * value / (top || 1));
        pen.stroke();
    });
    pen.fillStyle = style.getPropertyValue('--soft');
    pen.font = `11px ${style.fontFamily}`;
    pen.fillText(short(top), 5, 12);
}

// A cell's bar: as long as the share, and what it is of where that is not the row's; and the paper's, where
// it gives one.
export function setBar(cell, share, of, paperPercent) {
    const paper = Number.isFinite(paperPercent) ? ` (paper ${paperPercent} %)` : '';
    cell.textContent = Number.isFinite(share) ? `${Math.round(100 * share)} %${of}${paper}` : '–';
    cell.style.setProperty('--share', `${Number.isFinite(share) ? 100 * share : 0}%`);
}
