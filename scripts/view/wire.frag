#version 300 es
// wire.frag - a thin line, which fades into the background with depth.
precision highp float;
in vec3 tone;
in float far;
uniform vec3 behind; // the view's colour
uniform float strength;
out vec4 pixel;

void main()
{
    pixel = vec4(mix(tone, behind, 0.7 * far), 1.0) * strength; // premultiplied
}
