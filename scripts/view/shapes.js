// shapes.js - triangles of a scene's obstacles, and where its ground is.
import { add, cross, unit } from 'view/camera';

const ROUND = 24; // divisions of a circle

// A capsule between a and b, as one band of rings from pole to pole; a sphere where a is b.
function addCapsule(mesh, a, b, radius) {
    const axis = Math.hypot(...add(b, a, -1)) > 0 ? unit(add(b, a, -1)) : [0, 1, 0];
    const side = unit(cross(axis, Math.abs(axis[0]) < 0.7 ? [1, 0, 0] : [0, 0, 1]));
    const other = cross(axis, side);
    const first = mesh.points.length / 3;
    for (let ring = 0; ring <= ROUND; ring++) {
        const turn = Math.PI * (ring / ROUND - 0.5);
        const middle = ring < ROUND / 2 ? a : b;
        for (let i = 0; i <= ROUND; i++) {
            const angle = 2 * Math.PI * i / ROUND;
            const out = add(side.map((x) => x * Math.cos(angle)), other, Math.sin(angle));
            const normal = add(out.map((x) => x * Math.cos(turn)), axis, Math.sin(turn));
            mesh.points.push(...add(middle, normal, radius));
            mesh.normals.push(...normal);
        }
    }
    for (let ring = 0; ring < ROUND; ring++)
        for (let i = 0; i < ROUND; i++) {
            const at = first + ring * (ROUND + 1) + i;
            mesh.indices.push(at, at + 1, at + ROUND + 2, at, at + ROUND + 2, at + ROUND + 1);
        }
}

function addBox(mesh, low, high) {
    for (let d = 0; d < 3; d++)
        for (const sign of [-1, 1]) {
            const first = mesh.points.length / 3;
            const [u, v] = sign > 0 ? [(d + 1) % 3, (d + 2) % 3] : [(d + 2) % 3, (d + 1) % 3];
            for (const [s, t] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
                const point = [0, 0, 0];
                point[d] = sign > 0 ? high[d] : low[d];
                point[u] = s ? high[u] : low[u];
                point[v] = t ? high[v] : low[v];
                mesh.points.push(...point);
                mesh.normals.push(...[0, 1, 2].map((e) => (e === d ? sign : 0)));
            }
            mesh.indices.push(first, first + 1, first + 2, first, first + 2, first + 3);
        }
}

// The triangles of all obstacles that have an end.
export function meshObstacles(obstacles) {
    const mesh = { points: [], normals: [], indices: [] };
    for (const { kind, a, b, radius } of obstacles) {
        if (kind === 'sphere') addCapsule(mesh, a, a, radius);
        if (kind === 'capsule') addCapsule(mesh, a, b, radius);
        if (kind === 'box') addBox(mesh, a, b);
    }
    return {
        points: new Float32Array(mesh.points),
        normals: new Float32Array(mesh.normals),
        indices: new Uint32Array(mesh.indices),
    };
}

// Planes to draw: those of the scene; the first is the ground, on which shadows fall. Where none faces
// upwards, a ground below the body is drawn that nothing touches.
export function findGrounds(bounds, obstacles) {
    const planes = obstacles.filter(({ kind }) => kind === 'plane')
        .map(({ a, b }) => ({ point: a, normal: unit(b) }));
    const ground = planes.findIndex((plane) => plane.normal[1] > 0.3);
    if (ground >= 0) return [planes[ground], ...planes.filter((plane, i) => i !== ground)];
    const size = Math.max(...add(bounds.high, bounds.low, -1));
    const free = { point: [0, bounds.low[1] - 0.2 * size, 0], normal: [0, 1, 0] };
    return [free, ...planes];
}

// The part of the world that the camera shows first: the body at rest, and what is near it.
export function findStage(bounds, obstacles) {
    const stage = { low: [...bounds.low], high: [...bounds.high] };
    const size = Math.max(...add(bounds.high, bounds.low, -1));
    const include = (point, radius) => {
        for (let d = 0; d < 3; d++) {
            if (point[d] < bounds.low[d] - size || point[d] > bounds.high[d] + size) continue;
            stage.low[d] = Math.min(stage.low[d], point[d] - radius);
            stage.high[d] = Math.max(stage.high[d], point[d] + radius);
        }
    };
    for (const { kind, a, b, radius } of obstacles) {
        if (kind === 'plane' && b[1] > 0.9 && bounds.low[1] - a[1] < 1.5 * size)
            stage.low[1] = Math.min(stage.low[1], a[1]);
        if (kind !== 'plane') include(a, kind === 'box' ? 0 : radius);
        if (kind === 'box' || kind === 'capsule') include(b, kind === 'box' ? 0 : radius);
    }
    return stage;
}
