#version 300 es
// surface.vert - a body's or an obstacle's surface.
in vec3 point;
in vec3 normal;
in float apart; // cells from the other engine's surface; 0 where none is given
uniform mat4 view;
out vec3 at;
out vec3 facing;
out float away;

void main()
{
    at = point;
    facing = normal;
    away = apart;
    gl_Position = view * vec4(point, 1.0);
}
