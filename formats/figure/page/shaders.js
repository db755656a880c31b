// --- Programs of the graphics card

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
`;

/** Places relative to the camera's target: the difference of two numbers each, of which floats lose nothing. */
const PLACING = `
uniform vec3 targetHigh, targetLow;
uniform mat3 axes;
uniform float scale;
uniform vec2 middle;

vec3 seenFrom(vec3 high, vec3 low) {
  return scale * (((high - targetHigh) + (low - targetLow)) * axes);
}

vec4 placed(vec3 seen) {
  // any depth, however large, and fine around the target
  float depth = -seen.z / (abs(seen.z) + 4.0 * (middle.x + middle.y));
  return vec4(seen.xy / middle, depth, 1.0);
}
`;

const CELLS_VERTEX = HEAD + PLACING + `
uniform sampler2D high, low, levels;
uniform ivec4 nodes;   // first node, steps along both directions, cells along the second
uniform ivec3 cells;   // first cell, steps along both directions
uniform vec2 first;    // indices of the first node
out vec2 place;        // indices, between those of nodes
out vec3 seen;
flat out float level;
const ivec2 CORNERS[6] = ivec2[6](
  ivec2(0, 0), ivec2(1, 0), ivec2(1, 1), ivec2(0, 0), ivec2(1, 1), ivec2(0, 1));

ivec2 texel(sampler2D table, int n) {
  int width = textureSize(table, 0).x;
  return ivec2(n % width, n / width);
}

void main() {
  int number = gl_VertexID / 6;
  ivec2 cell = ivec2(number / nodes.w, number % nodes.w);
  ivec2 corner = cell + CORNERS[gl_VertexID % 6];
  ivec2 at = texel(high, nodes.x + corner.x * nodes.y + corner.y * nodes.z);
  seen = seenFrom(texelFetch(high, at, 0).xyz, texelFetch(low, at, 0).xyz);
  gl_Position = placed(seen);
  place = vec2(corner) + first;
  level = texelFetch(levels, texel(levels, cells.x + cell.x * cells.y + cell.y * cells.z), 0).x;
}
`;

const CUT_VERTEX = HEAD + PLACING + `
uniform sampler2D levels;
in vec3 high, low;
in float cell, rim;
out float inward;
out vec3 seen;
flat out float level;

void main() {
  seen = seenFrom(high, low);
  gl_Position = placed(seen);
  inward = rim;
  int n = int(cell), width = textureSize(levels, 0).x;
  level = texelFetch(levels, ivec2(n % width, n / width), 0).x;
}
`;

const fragment = (lines) => HEAD + `
in vec3 seen;
flat in float level;
uniform sampler2D colours;
uniform vec2 limits;
uniform vec3 plain;      // colour where cells are not coloured
uniform bool coloured, reversed, lit;
uniform float gap;       // least distance of lines in pixels, 0 for none
uniform float every;     // distance of lines in cells, 0 to choose
out vec4 colour;
const vec3 INK = vec3(0.106, 0.153, 0.2);
const vec3 LIGHT = normalize(vec3(-0.36, 0.48, 0.8));
${lines}
void main() {
  float part = clamp((level - limits.x) / (limits.y - limits.x), 0.0, 1.0);
  vec3 face = coloured ? texture(colours, vec2(reversed ? 1.0 - part : part, 0.5)).rgb : plain;
  if (lit) {
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    face *= min(1.0, 0.68 + 0.34 * abs(dot(normal, LIGHT)));
  }
  if (gap > 0.0) {
    float dark = step(dot(face, vec3(0.3, 0.6, 0.1)), 0.32);
    face = mix(face, mix(INK, vec3(1.0), dark), ruled() * mix(coloured ? 0.5 : 0.75, 0.55, dark));
  }
  colour = vec4(face, 1.0);
}
`;

const CELLS_FRAGMENT = fragment(`
in vec2 place;

vec2 near(vec2 lines, vec2 density) {
  vec2 away = abs(mod(place + 0.5 * lines, lines) - 0.5 * lines) / density;
  return clamp(1.05 - away, 0.0, 1.0);
}

// how much of a line is here: lines keep their distance, every other one fades where they come too close
float ruled() {
  vec2 density = max(vec2(length(vec2(dFdx(place.x), dFdy(place.x))),
                          length(vec2(dFdx(place.y), dFdy(place.y)))), vec2(1e-9));
  if (every > 0.0) {
    vec2 on = near(vec2(every), density);
    return max(on.x, on.y);
  }
  vec2 octave = max(log2(gap * density), vec2(0.0));
  vec2 lines = exp2(floor(octave));
  vec2 on = max(near(lines, density) * (1.0 - fract(octave)), near(2.0 * lines, density));
  return max(on.x, on.y);
}
`);

const CUT_FRAGMENT = fragment(`
in float inward;

// a line around each polygon, fainter where these are small
float ruled() {
  float density = max(length(vec2(dFdx(inward), dFdy(inward))), 1e-9);
  return clamp(0.85 - inward / density, 0.0, 1.0) * clamp(1.6 / (gap * density), 0.0, 1.0);
}
`);

const SEGMENTS_VERTEX = HEAD + PLACING + `
in vec3 startHigh, startLow, stopHigh, stopLow;
uniform float width, forward;
out vec2 from;
flat out float along;

void main() {
  vec3 a = seenFrom(startHigh, startLow), b = seenFrom(stopHigh, stopLow);
  vec2 way = b.xy - a.xy;
  along = length(way);
  way = along > 1e-6 ? way / along : vec2(1.0, 0.0);
  float reach = 0.5 * width + 1.0;
  bool last = gl_VertexID > 1;
  float side = gl_VertexID % 2 == 0 ? -reach : reach;
  vec3 end = last ? b : a;
  end.xy += (last ? reach : -reach) * way + side * vec2(-way.y, way.x);
  end.z += forward;
  gl_Position = placed(end);
  from = vec2(last ? along + reach : -reach, side);
}
`;

const SEGMENTS_FRAGMENT = HEAD + `
in vec2 from;
flat in float along;
uniform float width;
uniform vec4 ink;
out vec4 colour;

void main() {
  float away = length(vec2(from.x - clamp(from.x, 0.0, along), from.y));
  float cover = clamp(0.5 * width + 0.5 - away, 0.0, 1.0) * ink.a;
  if (cover < 0.004) discard;
  colour = vec4(ink.rgb, cover);
}
`;
