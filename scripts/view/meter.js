// meter.js - what a side takes of time in this browser, and how its motion went in the last seconds.
const LEAST_MS = 500; // what a mean is of; without a display so many steps are enough
const LEAST_STEPS = 50;
const SECONDS = 10;

export class Meter {
    constructor() { this.clear(); }

    clear() {
        Object.assign(this, { stepMs: NaN, frameMs: NaN, shares: [], trace: [] });
        this.begin();
    }

    begin() { Object.assign(this, { steps: 0, frames: 0, stepping: 0, whole: 0, since: performance.now() }); }

    // A frame's steps took `stepping` ms, and with finding and sending the surface `whole`.
    add(steps, stepping, whole) {
        this.steps += steps;
        this.frames++;
        this.stepping += stepping;
        this.whole += whole;
    }

    // Takes the means anew when they are of enough; `stages()` are the ms a step of each stage.
    settle(stages, soon) {
        const long = performance.now() - this.since > LEAST_MS;
        if (!this.steps || !(long || (soon && this.steps >= LEAST_STEPS))) return;
        this.stepMs = this.stepping / this.steps;
        this.frameMs = this.whole / this.frames;
        const each = stages();
        const sum = each.reduce((a, b) => a + b, 0);
        this.shares = each.map((ms) => ms / sum);
        this.begin();
    }

    // What was at a time of play, in seconds.
    note(time, kinetic, momentum) {
        this.trace.push({ time, kinetic, momentum });
        while (this.trace[0].time < time - SECONDS) this.trace.shift();
    }
}
