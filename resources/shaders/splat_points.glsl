// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Points through the lens onto pixels: the twin of src/raster/splat_kernel_body.h, held to it by a test. The including
// shader says how a pixel keeps the nearest: void put(uint at, float depth, uint payload).

#ifndef ALIDADE_SPLAT_POINTS_GLSL
#define ALIDADE_SPLAT_POINTS_GLSL

#extension GL_GOOGLE_include_directive : require
#include "distortion.glsl"

layout(local_size_x = 256) in;

// A run of points of one node: SplatRunBlock of src/overlay/vulkan_splatter.cpp.
struct Run {
  vec4 x, y, z;  // rows: camera axes from node steps, then the node's origin
  vec4 size;     // footprint: size times depth, smallest, largest (0: one pixel), 1 where round
  ivec4 cells;   // first step of the normals' cells, then their shift
  uvec4 what;    // payload of the first point, first normal (all ones: none), what footprints lose (a float's bits), 1: into levels
};

layout(std140, set = 0, binding = 0) uniform FrameBlock {
  LensUniform lens;
  vec4 fold;     // fold-back radius squared, last level
  uvec4 frame;   // width, height, 1 where the payload is the colour, chunks
  ivec4 levels[8];  // columns, rows, first pixel, margin: SplatLevels of src/raster/splat_levels.h
};
layout(std430, set = 0, binding = 1) readonly buffer PointBlock { uvec2 points[]; };  // x | y << 16, z | rgb565 << 16
layout(std430, set = 0, binding = 2) readonly buffer ChunkBlock { uvec4 chunks[]; };  // run, first point, count, place in run
layout(std430, set = 0, binding = 3) readonly buffer RunBlock { Run runs[]; };
layout(std430, set = 0, binding = 4) readonly buffer NormalBlock { vec4 normals[]; };

void put(uint at, float depth, uint payload);

void drawPixel(vec2 at, float z, uint payload) {
  vec2 pixel = floor(at + 0.5);
  if (!(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < float(frame.x) && pixel.y < float(frame.y))) return;
  put(uint(pixel.y) * frame.x + uint(pixel.x), z, payload);
}

void drawIntoLevel(int level, ivec2 pixel, vec2 at, float z, uint payload) {
  ivec4 of = levels[level];
  if (frame.z == 1u && level > 0) {  // PlaceInCell of src/raster/splat_levels.h
    ivec2 place = clamp(ivec2((at - vec2(pixel - (pixel & ((1 << level) - 1)))) * float(256 >> level)), ivec2(0), ivec2(255, 254));
    payload |= uint(place.x | place.y << 8) << 16;
  }
  ivec2 cell = (pixel >> level) + of.w;
  if (all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, of.xy))) put(uint(cell.y * of.x + cell.x + of.z), z, payload);
}

// A cell at least as wide as the points are apart, and its detail in the next finer level.
void drawLevels(Run run, vec2 at, float z, uint payload) {
  precise float width = min(run.size.x * (1.0 / z), run.size.z);
  int level = clamp(((floatBitsToInt(width) - 1) >> 23) - 126, 0, int(fold.y));
  if (!(abs(at.x) < 1e6 && abs(at.y) < 1e6)) return;  // outside of any level, or no number
  ivec2 pixel = ivec2(floor(at + 0.5));
  drawIntoLevel(level, pixel, at + 0.5, z, payload);
  if (level > 0) drawIntoLevel(level - 1, pixel, at + 0.5, z, payload);
}

// How many times its inverse depth a footprint gains along u and along v, a pixel; false where it is of one depth.
bool tiltOf(vec3 normal, vec2 xy, vec2 at, out vec2 along) {
  float step = 0.01 * (1.0 + (xy.x * xy.x + xy.y * xy.y));
  vec2 alongX = (pixelOfDistorted(distortPoint(xy + vec2(step, 0.0), lens), lens) - at) * (1.0 / step);
  vec2 alongY = (pixelOfDistorted(distortPoint(xy + vec2(0.0, step), lens), lens) - at) * (1.0 / step);
  float facing = normal.x * xy.x + normal.y * xy.y + normal.z;
  float determinant = alongX.x * alongY.y - alongY.x * alongX.y;
  if (!(abs(facing) > 1e-3) || !(abs(determinant) > 1e-6)) return false;
  float scale = 1.0 / (facing * determinant);
  along = vec2(normal.x * alongY.y - normal.y * alongX.y, normal.y * alongX.x - normal.x * alongY.x) * scale;
  return true;
}

vec4 surfaceAt(Run run, uvec3 steps) {
  if (run.what.y == 0xffffffffu) return vec4(0.0, 0.0, 0.0, 1.0);
  ivec3 cell = clamp((ivec3(steps) - run.cells.xyz) >> run.cells.w, ivec3(0), ivec3(7));
  return normals[run.what.y + uint(cell.x + 8 * cell.y + 64 * cell.z)];
}

void drawFootprint(Run run, uvec3 steps, vec2 xy, vec2 at, float z, uint payload) {
  vec4 surface = surfaceAt(run, steps);
  precise float size = max(min(run.size.x * surface.w * (1.0 / z) - uintBitsToFloat(run.what.z), run.size.z), run.size.y);
  float halfSize = 0.5 * size;
  vec2 extent = vec2(frame.xy);
  if (!(at.x + halfSize > -0.5 && at.x - halfSize < extent.x - 0.5 && at.y + halfSize > -0.5 &&
        at.y - halfSize < extent.y - 0.5)) return;
  vec2 along = vec2(0.0);
  float h = min(size * (0.5 / lens.focal.x), 0.3);
  bool isTilted = run.what.y != 0xffffffffu && size > 2.0;
  bool hasPlane = isTilted && tiltOf(surface.xyz, xy, at, along);
  if (!hasPlane) along = vec2(0.0);
  float bend = (hasPlane ? 0.0005 : 1.6 * h) / (size * size);  // without a plane a dome
  float least = h * (h - 1.0), most = h * (h + 1.0);
  ivec2 first = max(ivec2(floor(at - halfSize)) + 1, ivec2(0));
  ivec2 last = min(ivec2(floor(at + halfSize)), ivec2(frame.xy) - 1);
  ivec2 middle = ivec2(floor(at + 0.5));
  float radiusSquared = run.size.w > 0.5 && size > 2.0 ? halfSize * halfSize : size * size;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      vec2 off = vec2(x, y) - at;
      if (off.x * off.x + off.y * off.y > radiusSquared) continue;
      float depth = z;
      if (isTilted) {
        float free = off.x * (along.x - bend * off.x) + off.y * (along.y - bend * off.y);
        if ((free < least || free > most) && ivec2(x, y) != middle) continue;
        float t = clamp(free, least, most);
        depth = z * (1.0 - t * (1.0 - t));
      }
      put(uint(y) * frame.x + uint(x), depth, payload);
    }
  }
}

void main() {
  uint chunk = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
  if (chunk >= frame.w) return;
  uvec4 range = chunks[chunk];
  uint i = gl_LocalInvocationID.x;
  if (i >= range.z) return;
  Run run = runs[range.x];
  uvec2 raw = points[range.y + i];
  uvec3 steps = uvec3(raw.x & 0xffffu, raw.x >> 16, raw.y & 0xffffu);
  vec3 p = vec3(steps);
  // No contraction into fused operations: sums as the processor's.
  precise vec3 q = vec3((run.x.x * p.x + run.x.y * p.y) + (run.x.z * p.z + run.x.w),
                        (run.y.x * p.x + run.y.y * p.y) + (run.y.z * p.z + run.y.w),
                        (run.z.x * p.x + run.z.y * p.y) + (run.z.z * p.z + run.z.w));
  if (!(q.z > 1e-6)) return;
  precise vec2 xy = q.xy * (1.0 / q.z);
  if (!(xy.x * xy.x + xy.y * xy.y <= fold.x)) return;
  vec2 at = pixelOfDistorted(distortPoint(xy, lens), lens);
  uint payload = frame.z == 1u ? raw.y >> 16 : run.what.x + range.w + i;
  if (run.size.z == 0.0)
    drawPixel(at, q.z, payload);
  else if (run.what.w == 1u)
    drawLevels(run, at, q.z, payload);
  else
    drawFootprint(run, steps, xy, at, q.z, payload);
}

#endif
