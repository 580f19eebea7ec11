// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Design edges: the twin of resources/shaders/design_edge.frag, several pixels at a time. Blended by
// maximum, so that the pieces of a bent edge join without a seam.

#pragma once

#include "overlay/paint_lanes.h"

namespace alidade {
namespace {

/// Pixels of an edge: where they are, and the place on the line across from them.
struct EdgePixels {
  Ints active;
  Floats lineX, lineY;  ///< pixels
  Floats across, along, depth;
};

ALIDADE_LENS_INLINE Ints indexOf(const PaintFrame& frame, const Ints& x, const Ints& y) {
  return clamped(y, frame.height) * frame.width + clamped(x, frame.width);
}

/// 1 on the drawn part of a dash of about `pixels`: metres doubled or halved to fit the distance, so that
/// dashes stay tied to the edge while the camera moves.
ALIDADE_LENS_INLINE Ints isDrawn(const PaintFrame& frame, const EdgePixels& p, float pixels, float drawn) {
  const Floats metres = larger(p.depth * (pixels / frame.pixelsAtOneMetre), all(1e-6f));
  // The nearest power of two by ratio: rounds up from sqrt(2).
  const Floats period = reinterpret_cast<Floats>((asInts(metres) + (0x40000000 - 0x3fb504f3)) & 0x7f800000);
  return fraction(p.along / period) < drawn;
}

/// An edge is in front where one of the four pixels about the line itself shows a face that is not nearer.
ALIDADE_LENS_INLINE Ints isInFront(const PaintFrame& frame, const EdgePixels& p) {
  const Ints x = roundedDown(p.lineX), y = roundedDown(p.lineY);
  Floats farthest{};
  for (int i = 0; i < 4; ++i) {
    const Ints index = indexOf(frame, x + (i & 1), y + (i >> 1));
    farthest = larger(farthest, gatheredFloats(frame.faceDepth, index, p.active));
  }
  return p.active & (p.depth <= farthest * frame.edgeSlack);
}

/// What is drawn follows the faces that the edge bounds, judged aside of the line and along it, in doubt for
/// what is seen. Only an edge of no face asks the scan itself.
ALIDADE_LENS_INLINE Ints smoothState(const PaintFrame& frame, const ScreenEdge& e, const EdgePixels& p) {
  if (!frame.scanDepth) return Ints{};
  Ints visible{}, hidden{}, unknown{}, barely{};  // votes, counted downwards
  Ints open = p.active;
  const Floats x = p.lineX + 0.5f, y = p.lineY + 0.5f;
  for (int i = 0; i < 8; ++i) {
    if (i == 4) {
      const Ints sum = visible + hidden + unknown;
      const Ints isSettled =
          (barely == 0) & (smaller(smaller(visible, hidden), unknown) == sum) & (sum <= -2);
      open &= ~isSettled;
      if (!any(open)) break;
    }
    const float side = ((i & 1) != 0 ? 1.0f : -1.0f) * (i < 4 ? 2.0f : 5.0f) * frame.scale;
    const float ahead = ((i & 2) != 0 ? 1.0f : -1.0f) * (i < 4 ? 3.0f : 9.0f) * frame.scale;
    const Ints index = indexOf(frame, roundedDown(x + (ahead * e.ux - side * e.uy)),
                               roundedDown(y + (ahead * e.uy + side * e.ux)));
    const Ints key = gathered<1>(frame.key, index, open) & 255;
    const Ints mine = open & ((key >> 2) == static_cast<std::int32_t>(e.mark));
    const Ints state = key & 3;
    visible += mine & (state == kVisible);
    hidden += mine & (state == kHidden);
    unknown += mine & (state == kUnknown);
    barely += mine & (state == kBarelyHidden);
  }
  const Ints count = -(visible + hidden + unknown);
  Ints state = -3 * visible >= count ? all(kVisible) : (hidden <= unknown ? all(kHidden) : all(kUnknown));
  state = count == 0 ? all(kHidden) : state;
  const Ints asksScan = p.active & (count == 0) & (barely == 0);
  if (any(asksScan)) {
    const Floats scan =
        gatheredFloats(frame.scanDepth, indexOf(frame, roundedDown(x), roundedDown(y)), asksScan);
    state = asksScan ? stateOf(frame, p.depth - frame.tolerance, scan) : state;
  }
  return state;
}

/// Where one of the four pixels about the line shows the edge's own element in the hidden layer, and not
/// before the edge.
ALIDADE_LENS_INLINE Ints boundsHiddenLayer(const PaintFrame& frame, const ScreenEdge& e,
                                           const EdgePixels& p) {
  const auto own = static_cast<std::int32_t>(e.element);
  const Ints x = roundedDown(p.lineX), y = roundedDown(p.lineY);
  Floats farthest{};
  for (int i = 0; i < 4; ++i) {
    const Ints index = indexOf(frame, x + (i & 1), y + (i >> 1));
    const Ints mine = p.active & (gathered(frame.hiddenElement, index, p.active) == own);
    if (any(mine)) farthest = larger(farthest, gatheredFloats(frame.hiddenDepth, index, mine));
  }
  return p.active & (p.depth <= farthest * frame.edgeSlack);
}

/// What a look at the pixels themselves leaves of a run. Of what is not drawn, the depth test spares most of
/// the work: 6 % behind is far behind.
ALIDADE_LENS_INLINE Ints isOpen(const PaintFrame& frame, const ScreenEdge& e, EdgeLayer layer,
                                const Floats& depth, const Ints& active, std::size_t at, int some) {
  if (layer == EdgeLayer::Front)
    return active & (depth < 1.06f * loadSome<Floats>(frame.faceDepth + at, some));
  const auto own = static_cast<std::int32_t>(e.element);
  const Ints key = loadBytes(frame.key + at, some);
  const Ints open =
      active & (key != 0) & ((key & 3) == kVisible) & (loadSome<Ints>(frame.element + at, some) != own);
  if (!any(open)) return open;
  const Ints hidden = loadSome<Ints>(frame.hiddenElement + at, some);
  const Ints isNear = depth < 1.06f * loadSome<Floats>(frame.hiddenDepth + at, some);
  const Ints others = open & (hidden != 0) & (hidden != own);
  if (!any(others)) return open & ((hidden == 0) | isNear);
  const Ints style = (hidden - 1) * static_cast<int>(sizeof(PaintStyle) / 8);
  const Floats rank = gatheredFloats<8>(&frame.styles->rank, style, others);
  return open &
         ((hidden == 0) | (others & (rank < e.rank)) | (((hidden == own) | (rank == e.rank)) & isNear));
}

/// Line and casing of the pixels in the four bytes of EdgeTile::cover.
ALIDADE_LENS_INLINE Words coverOf(const PaintFrame& frame, const EdgePixels& p, const Ints& state) {
  const Floats one = all(1.0f), zero{};
  Floats strength = one, casing = all(0.5f);
  const Ints isHidden = state == kHidden, isUnknown = state == kUnknown;
  if (any(p.active & isUnknown)) {
    const Floats dashes = isDrawn(frame, p, 6.0f * frame.scale, 0.45f) ? all(0.6f) : zero;
    strength = isUnknown ? dashes : strength;
    casing = isUnknown ? 0.3f * dashes : casing;
  }
  Floats halfWidth = all(frame.edgeHalfWidth), halfCasing = all(frame.casingHalfWidth);
  if (any(p.active & isHidden)) {
    Floats faint = all(frame.hiddenStyle == kGhost ? 0.6f : 0.0f);
    if (frame.hiddenStyle == kDash) faint = isDrawn(frame, p, 16.0f * frame.scale, 0.55f) ? all(0.8f) : zero;
    strength = isHidden ? faint : strength;
    casing = isHidden ? 0.35f * faint : casing;
    halfWidth = isHidden ? 0.75f * halfWidth : halfWidth;
    halfCasing = isHidden ? 0.85f * halfCasing : halfCasing;
  }
  // A trace stays where nothing is drawn, so that what has edges alone can still be picked and counted.
  casing = larger(casing, all(0.005f));
  const Floats distance = absolute(p.across);
  const Floats line = strength * smaller(larger(halfWidth + 0.5f - distance, zero), one);
  const Floats edge = casing * smaller(larger(halfCasing + 0.5f - distance, zero), one);
  const Ints bytes = p.active & (truncated(255.0f * line + 0.5f) | truncated(255.0f * edge + 0.5f) << 8);
  return asWords((edge > 0.0f) & (isHidden ? bytes << 16 : bytes));
}

/// Pixels of an edge that wait until a vector is full: x in the low half, y above it.
struct EdgeQueue {
  std::int32_t pixels[2 * kLanes];
  int count = 0;
};

/// A vector of pixels anywhere on an edge. No pixel comes twice.
ALIDADE_LENS_INLINE void drawPixels(const PaintFrame& frame, const ScreenEdge& e, EdgeLayer layer,
                                    const Ints& pixels, int count, int left, int top, const EdgeTile& tile) {
  const Ints x = pixels & 0xffff, y = pixels >> 16;
  const Floats column = toFloats(x), row = toFloats(y);
  const Floats dx = column - e.x, dy = row - e.y;
  const Floats t = e.ux * dx + e.uy * dy;
  EdgePixels p;
  p.active = kIota < count;
  p.across = e.ux * dy - e.uy * dx;
  p.depth = 1.0f / (e.w0 + e.dw * t);
  p.lineX = column + p.across * e.uy;
  p.lineY = row - p.across * e.ux;
  p.active = layer == EdgeLayer::Behind ? boundsHiddenLayer(frame, e, p) : isInFront(frame, p);
  if (!any(p.active)) return;
  const Ints state = layer == EdgeLayer::Behind ? all(kHidden) : smoothState(frame, e, p);
  p.along = (e.q0 + e.dq * t) * p.depth;
  const Words cover = coverOf(frame, p, state);
  const Ints written = asInts(cover) != 0;
  const Ints place = (y - top) * kTileSize + x - left;
  const Bytes old = reinterpret_cast<Bytes>(gathered(tile.cover, place, written));
  const Ints most = reinterpret_cast<Ints>(larger(old, reinterpret_cast<Bytes>(cover)));
  for (unsigned bits = bitsOf(written); bits; bits &= bits - 1) {
    const int lane = __builtin_ctz(bits);
    tile.cover[place[lane]] = static_cast<std::uint32_t>(most[lane]);
    tile.element[place[lane]] = e.element;
    tile.depth[place[lane]] = p.depth[lane];
  }
}

/// Queues what may be drawn of a run of pixels of one row.
ALIDADE_LENS_INLINE void queueRun(const PaintFrame& frame, const ScreenEdge& e, EdgeLayer layer, int x, int y,
                                  int some, EdgeQueue& queue) {
  const Floats dx = toFloats(kIota + x) - e.x;
  const float dy = static_cast<float>(y) - e.y;
  const Floats t = e.ux * dx + e.uy * dy;
  const Floats across = e.ux * dy - e.uy * dx;
  const Floats w = e.w0 + e.dw * t;
  const Ints active = (kIota < some) & (t >= 0.0f) & (t <= e.length) &
                      (absolute(across) < frame.casingHalfWidth + 0.5f) & (w > 0.0f);
  const std::size_t at = static_cast<std::size_t>(y) * frame.width + x;
  const Ints open = isOpen(frame, e, layer, 1.0f / w, active, at, some);
  if (any(open)) queue.count += append(queue.pixels + queue.count, (kIota + x) | y << 16, open);
}

/// Whether the faces of a run let an edge be seen that comes no nearer than `nearest`.
ALIDADE_LENS_INLINE bool mayBeSeen(const PaintFrame& frame, int x, int y, int count, float nearest) {
  const float* depth = frame.faceDepth + static_cast<std::size_t>(y) * frame.width + x;
  for (; count > 0; count -= kLanes, depth += kLanes)
    if (any((loadSome<Floats>(depth, count) * 1.06f > nearest) & (kIota < count))) return true;
  return false;
}

void drawEdges(const PaintFrame& frame, const ScreenEdge* edges, const std::uint32_t* list,
               std::uint32_t count, EdgeLayer layer, const std::uint64_t* shown, int left, int top,
               const EdgeTile& tile) {
  const float reach = frame.casingHalfWidth + 0.5f;
  for (std::uint32_t i = 0; i < count; ++i) {
    const ScreenEdge& e = edges[list[i]];
    if (i + 4 < count) __builtin_prefetch(edges + list[i + 4]);
    if (layer == EdgeLayer::Behind) {
      const unsigned bit = e.element % HiddenSet::kBits;
      if (!(shown[bit / 64] >> bit % 64 & 1)) continue;
    }
    const int yFirst = e.top > top ? e.top : top;
    const int yLast = e.bottom < top + kTileSize - 1 ? e.bottom : top + kTileSize - 1;
    const int low = e.left > left ? e.left : left;
    const int high = e.right < left + kTileSize - 1 ? e.right : left + kTileSize - 1;
    const float steep = e.uy < 0 ? -e.uy : e.uy;
    const bool isBanded = steep > 1e-4f;
    const float perRow = isBanded ? e.ux / e.uy : 0.0f, band = isBanded ? reach / steep : 0.0f;
    EdgeQueue queue;
    const float wEnd = e.w0 + e.dw * e.length;
    const float nearest = 1.0f / (e.w0 > wEnd ? e.w0 : wEnd);
    for (int y = yFirst; y <= yLast; ++y) {
      int first = low, last = high;
      if (isBanded) {
        const float middle = e.x + perRow * (static_cast<float>(y) - e.y);
        const float from = middle - band, to = middle + band;
        if (to < static_cast<float>(low) || from > static_cast<float>(high)) continue;
        first = from > static_cast<float>(low) ? static_cast<int>(from) : low;
        last = to < static_cast<float>(high) ? static_cast<int>(to) : high;
      }
      if (layer == EdgeLayer::Front && !mayBeSeen(frame, first, y, last - first + 1, nearest)) continue;
      for (int x = first; x <= last; x += kLanes) {
        queueRun(frame, e, layer, x, y, last - x + 1, queue);
        if (queue.count < kLanes) continue;
        drawPixels(frame, e, layer, load<Ints>(queue.pixels), kLanes, left, top, tile);
        queue.count -= kLanes;
        store(queue.pixels, load<Ints>(queue.pixels + kLanes));
      }
    }
    if (queue.count > 0) drawPixels(frame, e, layer, load<Ints>(queue.pixels), queue.count, left, top, tile);
  }
}

}  // namespace
}  // namespace alidade
