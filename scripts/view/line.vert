#version 300 es
// line.vert - a line some pixels wide, as a rectangle that faces the view.
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec4 paint; // colour; pixels
uniform mat4 view;
uniform vec3 screen; // half its width and height in pixels; pixels of a unit of width
out vec3 tone;
out float far;

void main()
{
    vec4 a = view * vec4(from, 1.0), b = view * vec4(to, 1.0);
    vec2 along = (b.xy / b.w - a.xy / a.w) * screen.xy;
    vec2 unit = length(along) > 0.0 ? normalize(along) : vec2(1.0, 0.0);
    float end = float(gl_VertexID >> 1), side = float(gl_VertexID & 1) * 2.0 - 1.0;
    vec2 off = vec2(-unit.y, unit.x) * side + unit * (end * 2.0 - 1.0);
    gl_Position = end < 0.5 ? a : b;
    gl_Position.xy += 0.5 * paint.w * screen.z * off / screen.xy * gl_Position.w;
    tone = paint.rgb;
    far = 0.0;
}
