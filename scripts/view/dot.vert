#version 300 es
// dot.vert - the places that are held.
in vec3 point;
uniform mat4 view;
uniform float size; // pixels

void main()
{
    gl_Position = view * vec4(point, 1.0);
    gl_PointSize = size;
}
