#version 300 es
// cell.vert - the twelve edges of an octree's cell, each instance's from its middle and half edges.
layout(location = 0) in vec3 centre;
layout(location = 1) in vec3 right;
layout(location = 2) in vec3 up;
layout(location = 3) in vec3 back;
layout(location = 4) in float level;
uniform mat4 view;
uniform vec3 levels[8];
uniform float middle;
uniform float reach;
out vec3 tone;
out float far;

void main()
{
    int edge = gl_VertexID >> 1, axis = edge >> 2;
    vec3 place; // of an end, in half edges
    place[axis] = float(gl_VertexID & 1) * 2.0 - 1.0;
    place[(axis + 1) % 3] = float(edge & 1) * 2.0 - 1.0;
    place[(axis + 2) % 3] = float(edge >> 1 & 1) * 2.0 - 1.0;
    vec3 shrunk = 0.97 * place; // so that neighbours' edges are seen beside each other
    vec3 at = centre + right * shrunk.x + up * shrunk.y + back * shrunk.z;
    gl_Position = view * vec4(at, 1.0);
    tone = levels[min(int(level), 7)];
    far = clamp(0.5 + 0.5 * (gl_Position.w - middle) / reach, 0.0, 1.0);
}
