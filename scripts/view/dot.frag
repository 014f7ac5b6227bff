#version 300 es
// dot.frag - a round dot with a dark edge, so that it shows on any colour.
precision highp float;
uniform vec3 colour;
out vec4 pixel;

void main()
{
    float r = length(gl_PointCoord - 0.5) * 2.0;
    float soft = fwidth(r);
    float cover = 1.0 - smoothstep(1.0 - soft, 1.0, r);
    float inside = 1.0 - smoothstep(0.68 - soft, 0.68, r);
    pixel = vec4(colour * inside, 1.0) * cover;
}
