#version 300 es
// ground.frag - a grid that fades out, and the body's shadow, softened with its map's smaller copies.
precision highp float;
in vec2 place;
uniform float extent;
uniform float reach; // of the shadow's map
uniform float spacing;
uniform vec3 ink;
uniform vec3 floorColour;
uniform float darkness;
uniform sampler2D shadows;
out vec4 pixel;

float lines(vec2 p)
{
    vec2 away = abs(fract(p - 0.5) - 0.5) / fwidth(p);
    return 1.0 - min(1.0, min(away.x, away.y));
}

float shadow(vec2 where)
{
    float sum = 0.0;
    for (int i = -2; i <= 2; i++)
        for (int j = -2; j <= 2; j++)
        {
            float weight = float((3 - abs(i)) * (3 - abs(j)));
            sum += weight * textureLod(shadows, where + vec2(i, j) * 0.006, 2.0).r;
        }
    return sum / 81.0;
}

void main()
{
    float fade = 1.0 - smoothstep(0.25, 1.0, length(place) / extent);
    vec2 where = place / reach * 0.5 + 0.5;
    float dark = darkness * shadow(where);
    float grid = 0.30 * lines(place / spacing) * fade;
    vec4 base = vec4(floorColour, 1.0) * 0.75 * fade;
    base = mix(base, vec4(ink, 1.0), grid);
    pixel = vec4(base.rgb * (1.0 - dark), base.a + (1.0 - base.a) * dark); // premultiplied
}
