// pick.js - which vertex of a surface is under a place of the view.

// How far along the ray the triangle at corners a, b, c (offsets into the points) is hit; Infinity
// where it is not.
function hitTriangle(p, a, b, c, origin, direction) {
    const [dx, dy, dz] = direction;
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const hx = dy * vz - dz * vy, hy = dz * vx - dx * vz, hz = dx * vy - dy * vx;
    const det = ux * hx + uy * hy + uz * hz;
    if (det === 0) return Infinity;
    const sx = origin[0] - p[a], sy = origin[1] - p[a + 1], sz = origin[2] - p[a + 2];
    const s = (sx * hx + sy * hy + sz * hz) / det;
    if (s < 0 || s > 1) return Infinity;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const t = (dx * qx + dy * qy + dz * qz) / det;
    if (t < 0 || s + t > 1) return Infinity;
    const far = (vx * qx + vy * qy + vz * qz) / det;
    return far > 0 ? far : Infinity;
}

const distance = (p, at, point) => Math.hypot(p[at] - point[0], p[at + 1] - point[1], p[at + 2] - point[2]);

// The vertex of the first triangle on the ray that is nearest to where it is hit, or -1.
export function pickHit({ points, indices }, { origin, direction }) {
    let first = Infinity;
    let hit = -1;
    for (let i = 0; i < indices.length; i += 3) {
        const [a, b, c] = [3 * indices[i], 3 * indices[i + 1], 3 * indices[i + 2]];
        const far = hitTriangle(points, a, b, c, origin, direction);
        if (far < first) [first, hit] = [far, i];
    }
    if (hit < 0) return -1;
    const place = origin.map((x, d) => x + first * direction[d]);
    const corners = [...indices.subarray(hit, hit + 3)];
    corners.sort((v, w) => distance(points, 3 * v, place) - distance(points, 3 * w, place));
    return corners[0];
}

// The vertex that is seen nearest to a place of the view, within `limit` half heights of it, or -1.
export function pickNear({ points }, camera, aspect, x, y, limit) {
    let nearest = -1;
    for (let v = 0; v < points.length / 3; v++) {
        const at = camera.project([points[3 * v], points[3 * v + 1], points[3 * v + 2]], aspect);
        const off = Math.hypot((at.x - x) * aspect, at.y - y);
        if (at.depth > 0 && off < limit) [limit, nearest] = [off, v];
    }
    return nearest;
}
