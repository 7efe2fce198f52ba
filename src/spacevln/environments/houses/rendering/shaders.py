"""The shading of houses: even light that leaves nothing black, with enough direction to tell faces apart.

A soft sky from above, a weak sun from one side, and a lamp at the camera; all per pixel. GLSL 1.30 (OpenGL 3.0) is enough.
"""

SKY = (0.78, 0.86, 0.93, 1.0)
ATTRIBUTES = ("position", "normal", "uv", "rgba", "marks", "instance")
OUTPUTS = ("out_rgb", "out_depth", "out_instance")

VERTEX_SHADER = """
#version 130
uniform mat4 clip_from_scene;
in vec3 position;
in vec3 normal;
in vec2 uv;
in vec4 rgba;
in vec4 marks;
in int instance;
out vec3 at;
out vec3 facing;
out vec2 texel;
flat out vec4 tint;
flat out vec3 look;
flat out int id;
void main() {
    gl_Position = clip_from_scene * vec4(position, 1.0);
    at = position;
    facing = normal;
    texel = uv;
    tint = rgba;
    look = vec3(marks.x * 255.0, marks.y, marks.z);
    id = instance;
}
"""

FRAGMENT_SHADER = """
#version 130
uniform sampler2DArray layers;
uniform vec3 eye;
uniform vec3 axis;
uniform float range;
in vec3 at;
in vec3 facing;
in vec2 texel;
flat in vec4 tint;
flat in vec3 look;
flat in int id;
out vec4 out_rgb;
out float out_depth;
out int out_instance;
void main() {
    vec3 to_eye = eye - at;
    float depth = -dot(to_eye, axis);
    vec3 n = normalize(facing);
    float lamp = max(dot(n, to_eye) * inversesqrt(dot(to_eye, to_eye)), 0.0);
    float light = 0.68 + 0.10 * n.z + dot(n.xy, vec2(0.10, 0.06)) + 0.24 * lamp;
    float gloss = lamp * lamp;
    gloss *= gloss;
    gloss *= gloss;
    vec3 albedo = tint.rgb;
    if (look.x < 254.5) albedo *= texture(layers, vec3(texel, look.x)).rgb;
    out_rgb = vec4(albedo * mix(light, 1.15, look.y) + 0.22 * look.z * gloss, tint.a);
    out_depth = depth <= range ? depth : 0.0;
    out_instance = id;
}
"""
