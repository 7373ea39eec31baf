// The shaders: light of welded vertices from a texture, tone as the renderer's own, and the overlays.

export const VERTEX = `#version 300 es
precision highp float;
precision highp sampler2D;
uniform mat4 view;
uniform sampler2D light, heat;
in vec3 position;
in uint vertex, side;
in vec2 texcoord;
in vec4 tint, glow;
out vec4 irradiance;
out vec2 uv;
out vec3 colour, emits, bary;
out float traced;
flat out uint which;
const uint NONE = 0xffffffffu;
void main() {
  gl_Position = view * vec4(position, 1.0);
  uv = texcoord;
  colour = tint.rgb;
  emits = glow.rgb;
  which = side;
  int corner = gl_VertexID % 3;
  bary = vec3(corner == 0, corner == 1, corner == 2);
  irradiance = vertex == NONE ? vec4(0.0) : texelFetch(light, ivec2(vertex & 2047u, vertex >> 11), 0);
  traced = side == NONE ? 0.0 : texelFetch(heat, ivec2(side & 2047u, side >> 11), 0).r;
}`;

export const FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D picture;
uniform bool textured, unlit, selected;
uniform vec3 base, emitted, mean;
uniform float exposure, opacity, cutoff, most;
uniform int curve, overlay, object;
in vec4 irradiance;
in vec2 uv;
in vec3 colour, emits, bary;
in float traced;
flat in uint which;
out vec4 shown;
const float PI = 3.14159265;

vec3 neutral(vec3 c) {
  c = max(c, 0.0);
  float least = min(c.r, min(c.g, c.b));
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  float peak = max(c.r, max(c.g, c.b));
  float start = 0.76, room = 1.0 - start;
  if (peak < start) return c;
  float now = 1.0 - room * room / (peak + room - start);
  c *= now / peak;
  float white = 1.0 - 1.0 / (0.15 * (peak - now) + 1.0);
  return mix(c, vec3(now), white);
}

vec3 agx(vec3 c) {
  const mat3 into = mat3(0.6274, 0.0691, 0.0164, 0.3293, 0.9195, 0.0880, 0.0433, 0.0113, 0.8956);
  const mat3 back = mat3(1.6605, -0.1246, -0.0182, -0.5876, 1.1329, -0.1006, -0.0728, -0.0083, 1.1187);
  const mat3 inset = mat3(0.856627153315983, 0.137318972929847, 0.11189821299995, 0.0951212405381588, 0.761241990602591,
    0.0767994186031903, 0.0482516061458583, 0.101439036467562, 0.811302368396859);
  const mat3 outset = mat3(1.1271005818144368, -0.1413297634984383, -0.14132976349843826, -0.11060664309660323,
    1.157823702216272, -0.11060664309660294, -0.016493938717834573, -0.016493938717834257, 1.2519364065950405);
  c = inset * (into * max(c, 0.0));
  c = clamp((log2(max(c, 1e-10)) + 12.47393) / 16.5, 0.0, 1.0);
  vec3 c2 = c * c, c4 = c2 * c2;
  c = 15.5 * c4 * c2 - 40.14 * c4 * c + 31.96 * c4 - 6.868 * c2 * c + 0.4298 * c2 + 0.1191 * c - 0.00232;
  c = pow(max(outset * c, 0.0), vec3(2.2));
  return back * c;
}

vec3 hue(float h) {
  return clamp(abs(mod(h * 6.0 + vec3(0.0, 4.0, 2.0), 6.0) - 3.0) - 1.0, 0.0, 1.0);
}

vec3 warmth(float t) {
  return clamp(vec3(1.5 - abs(4.0 * t - 3.0), 1.5 - abs(4.0 * t - 2.0), 1.5 - abs(4.0 * t - 1.0)), 0.0, 1.0);
}

float srgb(float c) {
  return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055;
}

void main() {
  vec4 texel = textured ? texture(picture, uv) : vec4(1.0);
  if (texel.a < cutoff) discard;
  vec3 albedo = base * colour * texel.rgb;
  vec3 falls = irradiance.a > 0.001 ? irradiance.rgb / irradiance.a : mean;
  vec3 radiance = unlit ? albedo : (albedo * falls + emitted * emits) / PI;
  float grey = dot(radiance, vec3(0.2126, 0.7152, 0.0722)) * exposure;
  vec3 c = radiance * exposure;
  c = curve == 1 ? neutral(c) : curve == 2 ? agx(c) : c;
  if (overlay == 1) c = mix(vec3(0.35 * min(grey, 1.0) + 0.01), vec3(1.0, 0.25, 0.02), traced > 0.0 ? 0.25 + 0.75 * traced : 0.0);
  if (overlay == 3) c = (0.25 + 0.75 * min(grey, 1.0)) * (0.2 + 0.8 * hue(fract(float(object) * 0.618034)));
  if (overlay == 4) c = pow(warmth(clamp(log2(1.0 + 255.0 * dot(falls, vec3(0.2126, 0.7152, 0.0722)) / most) / 8.0, 0.0, 1.0)), vec3(2.2));
  if (selected) c = mix(c, vec3(1.0, 0.55, 0.1), 0.05);
  c = clamp(c, 0.0, 1.0);
  c = vec3(srgb(c.r), srgb(c.g), srgb(c.b));
  if (overlay == 2 || selected) {
    vec3 width = fwidth(bary) * 1.1;
    vec3 near = smoothstep(vec3(0.0), width, bary);
    float line = 1.0 - min(near.x, min(near.y, near.z));
    c = mix(c, overlay == 2 ? vec3(0.1, 0.8, 0.9) : vec3(1.0, 0.6, 0.2), line * (overlay == 2 ? 0.7 : 0.25));
  }
  shown = vec4(c, opacity);
}`;
