#version 300 es
// shadow.vert - the body seen along a ground's normal.
in vec3 point;
uniform vec3 middle; // of the part of the ground that takes shadows
uniform vec3 across;
uniform vec3 along;
uniform vec3 upward;
uniform float reach;
out float height;

void main()
{
    vec3 p = point - middle;
    height = dot(p, upward) / reach;
    gl_Position = vec4(dot(p, across) / reach, dot(p, along) / reach, 0.0, 1.0);
}
