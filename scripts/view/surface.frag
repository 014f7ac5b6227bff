#version 300 es
// surface.frag - soft light: a sky, a ground, one lamp beside the eye, and a faint gloss.
precision highp float;
in vec3 at;
in vec3 facing;
in float away;
uniform vec3 eye;
uniform vec3 lamp; // unit, towards it
uniform vec3 colour;
uniform float gloss;
uniform float most;      // what `away` is that has the map's last colour; 0: no map
uniform float clearness; // 0 opaque, 1 glass, whose edges alone are seen well
out vec4 pixel;

// The map viridis from 0 to 1, as a polynomial.
vec3 viridis(float t)
{
    const vec3 a = vec3(0.2777, 0.0054, 0.3341), b = vec3(0.1051, 1.4046, 1.3846);
    const vec3 c = vec3(-0.3309, 0.2148, 0.0951), d = vec3(-4.6342, -5.7991, -19.3324);
    const vec3 e = vec3(6.2283, 14.1799, 56.6906), f = vec3(4.7764, -13.7451, -65.3530);
    const vec3 g = vec3(-5.4355, 4.6459, 26.3125);
    return a + t * (b + t * (c + t * (d + t * (e + t * (f + t * g)))));
}

void main()
{
    vec3 n = normalize(facing);
    vec3 v = normalize(eye - at);
    if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n; // the inside, seen through a cut
    float sky = 0.5 + 0.5 * n.y;
    float key = max(0.0, 0.8 * dot(n, lamp) + 0.2);
    float rim = pow(1.0 - max(0.0, dot(n, v)), 4.0);
    vec3 shown = most > 0.0 ? viridis(clamp(away / most, 0.0, 1.0)) : colour;
    vec3 material = pow(max(shown, 0.0), vec3(2.2));
    vec3 light = material * (mix(vec3(0.22, 0.20, 0.18), vec3(0.50, 0.53, 0.58), sky) + 0.95 * key);
    light += gloss * pow(max(0.0, dot(n, normalize(lamp + v))), 40.0) + 0.10 * rim * sky;
    float edge = pow(1.0 - min(1.0, abs(dot(n, v))), 2.0);
    float cover = mix(1.0, 0.13 + 0.55 * edge, clearness);
    pixel = vec4(pow(light, vec3(1.0 / 2.2)), 1.0) * cover; // premultiplied
}
