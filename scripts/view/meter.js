// meter.js - what a side takes of time in this browser, and how its motion went in the last seconds.
const LEAST_MS = 500; // what a mean is of; without a display so many steps are enough
const LEAST_STEPS = 50;
const SHARES_OF = 30; // ms of steps: each third one has clocks inside, which tell a tenth of a ms
const SECONDS = 10;

export class Meter {
    constructor() { this.clear(); }

    clear() {
        Object.assign(this, { stepMs: NaN, frameMs: NaN, pace: NaN, shares: [], trace: [], seen: 0 });
        this.begin();
    }

    // Without a time, that of what has been simulated, stages begin anew, too.
    begin(time = NaN) {
        Object.assign(this, { steps: 0, frames: 0, stepping: 0, whole: 0, time, since: performance.now() });
        if (Number.isNaN(time)) this.seen = 0;
    }

    // A frame's steps took `stepping` ms, and with finding and sending the surface `whole`.
    add(steps, stepping, whole) {
        this.steps += steps;
        this.frames++;
        this.stepping += stepping;
        this.whole += whole;
    }

    // Takes the means anew when they are of enough; `stages()` are the ms a step of each stage; `time` is what
    // has been simulated, s.
    settle(stages, soon, time) {
        const since = performance.now() - this.since;
        const long = since > LEAST_MS;
        if (!this.steps || !(long || (soon && this.steps >= LEAST_STEPS))) return;
        this.stepMs = this.stepping / this.steps;
        this.frameMs = this.whole / this.frames;
        this.pace = 1000 * (time - this.time) / since;
        this.seen += this.stepping;
        if (this.seen >= SHARES_OF) {
            const each = stages();
            const sum = each.reduce((a, b) => a + b, 0);
            this.shares = each.map((ms) => ms / sum);
            this.seen = 0;
        }
        this.begin(time);
    }

    // What was at a time of play, in seconds.
    note(time, kinetic, momentum) {
        this.trace.push({ time, kinetic, momentum });
        while (this.trace[0].time < time - SECONDS) this.trace.shift();
    }
}
