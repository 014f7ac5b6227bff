#version 300 es
// wire.vert - particles and links between them; what is farther away is fainter.
in vec3 point;
uniform mat4 view;
uniform vec3 colour;
uniform float size; // of a particle, pixels
uniform float middle; // of the body, from the eye
uniform float reach;
out vec3 tone;
out float far;

void main()
{
    gl_Position = view * vec4(point, 1.0);
    gl_PointSize = size;
    tone = colour;
    far = clamp(0.5 + 0.5 * (gl_Position.w - middle) / reach, 0.0, 1.0);
}
