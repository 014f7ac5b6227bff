#version 300 es
// surface.vert - a body's or an obstacle's surface.
in vec3 point;
in vec3 normal;
uniform mat4 view;
out vec3 at;
out vec3 facing;

void main()
{
    at = point;
    facing = normal;
    gl_Position = view * vec4(point, 1.0);
}
