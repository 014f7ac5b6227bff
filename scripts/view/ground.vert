#version 300 es
// ground.vert - a square of a plane, from its corners' numbers.
uniform mat4 view;
uniform vec3 middle;
uniform vec3 across;
uniform vec3 along;
uniform float extent;
out vec2 place; // from the middle, in the world's units

void main()
{
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
    place = corner * extent;
    gl_Position = view * vec4(middle + across * place.x + along * place.y, 1.0);
}
