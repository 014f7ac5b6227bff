#version 300 es
// surface.frag - soft light: a sky, a ground, one lamp beside the eye, and a faint gloss.
precision highp float;
in vec3 at;
in vec3 facing;
uniform vec3 eye;
uniform vec3 lamp; // unit, towards it
uniform vec3 colour;
uniform float gloss;
out vec4 pixel;

void main()
{
    vec3 n = normalize(facing);
    vec3 v = normalize(eye - at);
    if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n; // the inside, seen through a cut
    float sky = 0.5 + 0.5 * n.y;
    float key = max(0.0, 0.8 * dot(n, lamp) + 0.2);
    float rim = pow(1.0 - max(0.0, dot(n, v)), 4.0);
    vec3 material = pow(colour, vec3(2.2));
    vec3 light = material * (mix(vec3(0.22, 0.20, 0.18), vec3(0.50, 0.53, 0.58), sky) + 0.95 * key);
    light += gloss * pow(max(0.0, dot(n, normalize(lamp + v))), 40.0) + 0.10 * rim * sky;
    pixel = vec4(pow(light, vec3(1.0 / 2.2)), 1.0);
}
