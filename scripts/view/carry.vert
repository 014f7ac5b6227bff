#version 300 es
// carry.vert - a vertex of FastLSM's surface and its normal from where the eight particles are that
// carry it (fastlsm section 4, eqs. 15 to 17; bench/view/carried.h).
precision highp float;
precision highp sampler2D;
in ivec4 carriers0;
in ivec4 carriers1;
in vec4 phi0;
in vec4 phi1;
in vec4 u0;
in vec4 u1;
in vec4 v0;
in vec4 v1;
uniform sampler2D places; // of all bodies' particles, one after the other
uniform float particles; // of a body
out vec3 place;
out vec3 facing;

vec3 particle(int number)
{
    int n = gl_InstanceID * int(particles) + number;
    int row = textureSize(places, 0).x;
    return texelFetch(places, ivec2(n % row, n / row), 0).xyz;
}

void main()
{
    vec3 first = particle(carriers0.x);
    mat4x3 a = mat4x3(vec3(0.0), particle(carriers0.y) - first, particle(carriers0.z) - first,
        particle(carriers0.w) - first);
    mat4x3 b = mat4x3(particle(carriers1.x) - first, particle(carriers1.y) - first, particle(carriers1.z) - first,
        particle(carriers1.w) - first);
    place = first + a * phi0 + b * phi1;
    vec3 across = cross(a * u0 + b * u1, a * v0 + b * v1);
    float size = length(across);
    facing = size > 0.0 ? across / size : vec3(0.0);
    gl_Position = vec4(0.0);
}
