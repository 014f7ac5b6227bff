// camera.js - the one camera of both views: it turns about a target, and finds rays and pixels. Places
// in a view go from -1, left or bottom, to 1; `aspect` is the view's width over its height.

const SLOPE = Math.tan((32 / 2) * Math.PI / 180); // half the view's height at distance 1

export const add = (a, b, times = 1) => a.map((x, d) => x + times * b[d]);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) =>
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));

export class Camera {
    constructor() {
        Object.assign(this, { yaw: 0.5, pitch: 0.25, distance: 3, target: [0, 0, 0], size: 1 });
    }

    // Unit axes of the view: to the right, up, and back towards the eye.
    axes() {
        const [c, s] = [Math.cos(this.pitch), Math.sin(this.pitch)];
        const back = [Math.sin(this.yaw) * c, s, Math.cos(this.yaw) * c];
        const right = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
        return { right, up: cross(back, right), back };
    }

    eye() { return add(this.target, this.axes().back, this.distance); }

    // Half of what a view shows of the plane through the target, upwards.
    reach() { return this.distance * SLOPE; }

    // From the world to a view's clip space, by columns as WebGL wants it.
    matrix(aspect) {
        const { right, up, back } = this.axes();
        const eye = this.eye();
        const near = Math.max(this.distance - 6 * this.size, this.distance / 50);
        const far = this.distance + 12 * this.size;
        const depth = (far + near) / (near - far);
        const rows = [
            [...right, -dot(right, eye)].map((x) => x / (SLOPE * aspect)),
            [...up, -dot(up, eye)].map((x) => x / SLOPE),
            [...back, -dot(back, eye)].map((x) => x * depth),
            [...back, -dot(back, eye)].map((x) => -x),
        ];
        rows[2][3] += 2 * far * near / (near - far);
        return new Float32Array([0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column])));
    }

    // Where a point is in a view, and how far before the eye.
    project(point, aspect) {
        const { right, up, back } = this.axes();
        const from = add(point, this.eye(), -1);
        const depth = -dot(back, from);
        return { x: dot(right, from) / (depth * SLOPE * aspect), y: dot(up, from) / (depth * SLOPE), depth };
    }

    ray(x, y, aspect) {
        const { right, up, back } = this.axes();
        const across = add(right.map((r) => r * x * SLOPE * aspect), up, y * SLOPE);
        return { origin: this.eye(), direction: add(across, back, -1) };
    }

    // Where the ray through a place of the view meets the plane through `point` that faces the eye.
    onPlane(x, y, aspect, point) {
        const { back } = this.axes();
        const { origin, direction } = this.ray(x, y, aspect);
        const far = dot(back, add(point, origin, -1)) / dot(back, direction);
        return add(origin, direction, far);
    }

    // Neither it nor its target goes under the floor: sooner it looks down more steeply.
    rise() {
        if (!this.floor) return;
        const above = (place) => dot(this.floor.upward, add(place, this.floor.middle, -1));
        this.target = add(this.target, this.floor.upward, Math.max(0, -above(this.target)));
        while (this.pitch < 1.55 && above(this.eye()) < 0.02 * this.size) this.pitch += 0.01;
    }

    orbit(right, up) {
        this.yaw -= right;
        this.pitch = Math.min(1.55, Math.max(-1.2, this.pitch - up));
        this.rise();
    }

    // By shares of half the view's height.
    pan(right, up) {
        const axes = this.axes();
        this.target = add(add(this.target, axes.right, -right * this.reach()), axes.up, -up * this.reach());
        this.rise();
    }

    zoom(factor) {
        this.distance = Math.min(40 * this.size, Math.max(0.2 * this.size, this.distance * factor));
        this.rise();
    }

    // Looks at a box from the front so that it fills most of the view.
    frame(box, aspect) {
        const [width, height, depth] = add(box.high, box.low, -1);
        const flat = Math.max(0, 1 - height / Math.max(width, depth)); // what is flat is seen from higher up
        this.size = Math.hypot(width, height, depth) / 2 || 1;
        [this.yaw, this.pitch] = [0.5, 0.22 + 0.3 * flat * flat];
        this.target = add(box.low, box.high).map((x) => x / 2);
        const { right, up, back } = this.axes();
        this.distance = 0;
        for (let corner = 0; corner < 8; corner++) {
            const point = [0, 1, 2].map((d) => (corner >> d & 1 ? box.high : box.low)[d] - this.target[d]);
            const across = Math.abs(dot(right, point)) / (SLOPE * aspect * 0.86);
            const along = Math.abs(dot(up, point)) / (SLOPE * 0.8);
            this.distance = Math.max(this.distance, dot(back, point) + Math.max(across, along));
        }
    }
}
