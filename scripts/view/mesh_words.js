// mesh_words.js - words and numbers of a mesh file that is text, straight from its bytes: a string of the
// whole file would take seconds and twice the memory.

const [NEWLINE, RETURN] = [10, 13];
const [BACKSLASH, SHARP, SLASH] = [92, 35, 47];
const [MINUS, PLUS, POINT, ZERO] = [45, 43, 46, 48];
const POWERS = Array.from({ length: 23 }, (_, n) => Number(`1e${n}`)); // that a double holds exactly
const EXACT = 2 ** 53;
const NUMBER = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;
const NO_NUMBER = /^[-+]?(nan|inf|infinity)(\(\w*\))?$/i;

const isDigit = (byte) => byte >= ZERO && byte <= ZERO + 9;
const isEnd = (byte) => byte === undefined || byte <= 32 || byte === SLASH; // OBJ has one behind a number

export class Words {
    constructor(bytes, at = 0) {
        Object.assign(this, { bytes, at, newline: bytes.includes(NEWLINE) ? NEWLINE : RETURN });
    }

    // The sentence `words` with the number of the present line.
    wrong(words) {
        let line = 1;
        for (let at = 0; at < this.at; at++) line += this.bytes[at] === this.newline;
        return new Error(`line ${line}: ${words}; is it damaged or cut off? Export it again`);
    }

    ended() { return this.at >= this.bytes.length; }

    // Is there another word in this line? It begins here then. A '\' at a line's end goes on with the next.
    more() {
        const { bytes } = this;
        for (;; this.at++) {
            const byte = bytes[this.at];
            if (byte === undefined || byte === this.newline) return false;
            if (byte <= 32) continue;
            if (byte !== BACKSLASH || !(bytes[this.at + 1] <= 32)) return true;
            this.at = bytes.indexOf(this.newline, this.at);
            if (this.at < 0) this.at = bytes.length;
        }
    }

    // Goes to the next line; false where there is none.
    nextLine() {
        const end = this.bytes.indexOf(this.newline, this.at);
        this.at = end < 0 ? this.bytes.length : end + 1;
        return end >= 0;
    }

    // Goes to the next word, in whatever line; false where there is none.
    find() {
        while (!this.ended() && this.bytes[this.at] <= 32) this.at++;
        return !this.ended();
    }

    // The same, past comments that begin with '#'.
    findData() {
        while (this.find()) {
            if (this.bytes[this.at] !== SHARP) return true;
            this.nextLine();
        }
        return false;
    }

    // Past the word here, and it.
    word() {
        const start = this.at;
        while (!this.ended() && this.bytes[this.at] > 32) this.at++;
        return String.fromCharCode(...this.bytes.subarray(start, Math.min(this.at, start + 100)));
    }

    // Past the word here.
    skip() {
        while (!this.ended() && this.bytes[this.at] > 32) this.at++;
    }

    // Past the number here, and it; NaN for what stands for no finite one. A word that is no number is
    // an error.
    number() {
        const { bytes } = this;
        let at = this.at;
        const negative = bytes[at] === MINUS;
        if (negative || bytes[at] === PLUS) at++;
        let value = 0;
        let digits = 0;
        let scale = 0;
        for (; isDigit(bytes[at]); at++, digits++) value = 10 * value + bytes[at] - ZERO;
        if (bytes[at] === POINT)
            for (at++; isDigit(bytes[at]); at++, digits++, scale++) value = 10 * value + bytes[at] - ZERO;
        if (!digits || !isEnd(bytes[at]) || scale > 22 || value >= EXACT) return this.hardNumber();
        this.at = at;
        value /= POWERS[scale];
        return negative ? -value : value;
    }

    // One with an exponent or many digits, or none.
    hardNumber() {
        const start = this.at;
        const word = this.word().split('/')[0];
        this.at = start + word.length;
        if (NUMBER.test(word)) return Number(word);
        if (NO_NUMBER.test(word)) return NaN;
        this.at = start;
        throw this.wrong(`'${word.slice(0, 40)}' where a number should be`);
    }

    // A number that must stand in this line.
    numberInLine() {
        if (!this.more()) throw this.wrong('a number is missing');
        return this.number();
    }
}
