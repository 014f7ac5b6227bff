#version 300 es
// shadow.frag - the nearer to the ground, the darker; the darkest of all counts (blending).
precision highp float;
in float height;
out vec4 pixel;

void main()
{
    pixel = vec4(exp(-3.5 * max(height, 0.0)), 0.0, 0.0, 1.0);
}
