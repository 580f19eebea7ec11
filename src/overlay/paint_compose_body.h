// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Puts the picture together, once a pixel: the twin of resources/shaders/composite.frag, several pixels of a
// row at a time. What few pixels need is done for them alone.

#pragma once

#include "overlay/paint_lanes.h"

namespace alidade {
namespace {

/// Pixels of a row that are composed together.
struct Run {
  int x, y, some;
  std::size_t at;
  Floats column, row;  ///< of the pixels' centres, counted from the picture's corner
};

ALIDADE_LENS_INLINE Colours stretchedImage(const PaintFrame& f, const Run& run) {
  const Floats u = run.column * (static_cast<float>(f.imageWidth) / static_cast<float>(f.width)) - 0.5f;
  const Floats v = run.row * (static_cast<float>(f.imageHeight) / static_cast<float>(f.height)) - 0.5f;
  const Ints x = roundedDown(u), y = roundedDown(v);
  const Floats fx = u - toFloats(x), fy = v - toFloats(y);
  const Ints inside = kIota < run.some;
  const auto texel = [&](int i, int j) __attribute__((always_inline)) {
    const Ints index = clamped(y + j, f.imageHeight) * f.imageWidth + clamped(x + i, f.imageWidth);
    return unpacked(asWords(gathered(f.image, index, inside)));
  };
  return mix(mix(texel(0, 0), texel(1, 0), fx), mix(texel(0, 1), texel(1, 1), fx), fy);
}

ALIDADE_LENS_INLINE Colours cameraImage(const PaintFrame& f, const Run& run) {
  if (!f.image) return {all(255 * 0.11f), all(255 * 0.12f), all(255 * 0.14f)};
  const Colours c =
      f.imageFits ? unpacked(loadSome<Words>(f.image + run.at, run.some)) : stretchedImage(f, run);
  if (!f.grayImage) return c;
  const Floats gray = luminance(c);
  return {gray, gray, gray};
}

/// Holds on the stripes of a hatch that rises to the right.
ALIDADE_LENS_INLINE Ints hatch(const PaintFrame& f, const Run& run, float period, float drawn) {
  return fraction((run.column + run.row) / (period * f.scale)) < drawn;
}

/// Holds on dots in staggered rows.
ALIDADE_LENS_INLINE Ints dots(const PaintFrame& f, const Run& run, float period) {
  const Floats y = run.row / (period * f.scale);
  const Ints line = roundedDown(y);
  const Floats x = run.column / (period * f.scale) + 0.5f * toFloats(line & 1);
  const Floats dx = fraction(x) - 0.5f, dy = fraction(y) - 0.5f;
  return dx * dx + dy * dy < 0.06f;
}

/// Holds on the drawn part of an outline: cells of a chequerboard, which dash a line of any direction.
ALIDADE_LENS_INLINE Ints chequer(const PaintFrame& f, const Run& run, float size) {
  const Ints x = roundedDown(run.column / (size * f.scale)), y = roundedDown(run.row / (size * f.scale));
  return ((x + y) & 1) != 0;
}

ALIDADE_LENS_INLINE Colours designColour(const PaintFrame& f, const Colours& c) {
  if (!f.grayDesign) return c;
  const Floats gray = luminance(c);
  return {gray, gray, gray};
}

/// Keys or elements of the pixels beside the run; those of the picture's border are their own neighbours.
struct Around {
  Ints left, right, above, below;
};
template <class Element>
ALIDADE_LENS_INLINE Ints loadAny(const Element* from, int some) {
  if constexpr (sizeof(Element) == 1)
    return loadBytes(from, some);
  else
    return loadSome<Ints>(from, some);
}
template <class Element>
ALIDADE_LENS_INLINE Around loadAround(const PaintFrame& f, const Element* picture, const Run& run) {
  Around a;
  const Element* here = picture + run.at;
  a.above = loadAny(run.y > 0 ? here - f.width : here, run.some);
  a.below = loadAny(run.y + 1 < f.height ? here + f.width : here, run.some);
  if (run.x > 0 && run.x + kLanes < f.width) {
    a.left = loadAny(here - 1, run.some);
    a.right = loadAny(here + 1, run.some);
    return a;
  }
  a.left = a.right = Ints{};
  for (int i = 0; i < (run.some < kLanes ? run.some : kLanes); ++i) {
    a.left[i] = static_cast<std::int32_t>(here[run.x + i > 0 ? i - 1 : i]);
    a.right[i] = static_cast<std::int32_t>(here[run.x + i + 1 < f.width ? i + 1 : i]);
  }
  return a;
}

/// What a pixel of the front layer is drawn as where its neighbours disagree: specks, where the scan's noise
/// spoke, follow what most of the same element is around them. What is seen or hidden in more than a speck
/// stays, so that thin things stay in front; what is unknown or barely hidden always follows.
inline int drawnState(const PaintFrame& f, int x, int y, int key) {
  const int own = key & 3, mine = key >> 2;
  int votes[4] = {};
  for (int i = 0; i < 24; ++i) {
    if (i == 8) {
      if (own == kVisible && votes[kVisible] > 2) return kVisible;
      if (own == kHidden && votes[kHidden] + votes[kBarelyHidden] > 3) return kHidden;
    }
    int k = i & 7;
    k += k >> 2;  // 0 to 8 without the middle
    const int reach = 2 * (i >> 3) + 1;
    const int other = f.key[static_cast<std::size_t>(clamped(y + reach * (k / 3 - 1), f.height)) * f.width +
                            clamped(x + reach * (k % 3 - 1), f.width)];
    if (other >> 2 == mine) ++votes[other & 3];
  }
  const int count = votes[kVisible] + votes[kHidden] + votes[kUnknown];
  for (const int state : {kVisible, kHidden, kUnknown})
    if (2 * votes[state] > count) return state;
  return own == kBarelyHidden ? kHidden : own;
}

/// The same for a whole run that is five pixels and more from the picture's sides.
ALIDADE_LENS_INLINE Ints drawnInside(const PaintFrame& f, const Run& run, const Ints& key, const Ints& drawn,
                                     const Ints& isOpen) {
  const Ints own = key & 3, mine = key >> 2;
  Ints votes[4] = {};  // counted downwards
  Ints open = isOpen;
  for (int i = 0; i < 24 && any(open); ++i) {
    if (i == 8)
      open &= ~((own == kVisible) & (votes[kVisible] < -2)) &
              ~((own == kHidden) & (votes[kHidden] + votes[kBarelyHidden] < -3));
    int k = i & 7;
    k += k >> 2;
    const int reach = 2 * (i >> 3) + 1;
    const int y = clamped(run.y + reach * (k / 3 - 1), f.height), x = run.x + reach * (k % 3 - 1);
    const Ints other = loadBytes(f.key + static_cast<std::size_t>(y) * f.width + x, kLanes);
    const Ints same = (other >> 2) == mine;
    for (int state = 0; state < 4; ++state) votes[state] += same & ((other & 3) == state);
  }
  const Ints count = votes[kVisible] + votes[kHidden] + votes[kUnknown];
  Ints out = drawn;
  for (const int state : {kUnknown, kHidden, kVisible})
    out = open & (2 * votes[state] < count) ? all(state) : out;
  return out;
}

ALIDADE_LENS_INLINE Ints drawnStates(const PaintFrame& f, const Run& run, const Ints& key) {
  const Ints own = key & 3, mine = key >> 2;
  Ints drawn = own == kBarelyHidden ? all(kHidden) : own;
  if (!f.scanDepth) return drawn;
  const Around a = loadAround(f, f.key, run);
  Ints isOpen = (own == kUnknown) | (own == kBarelyHidden);
  for (const Ints& other : {a.left, a.right, a.above, a.below})
    isOpen |= (other != key) & ((other >> 2) == mine);
  isOpen &= (key != 0) & (kIota < run.some);
  if (!any(isOpen)) return drawn;
  if (run.x >= 5 && run.x + kLanes + 5 <= f.width) return drawnInside(f, run, key, drawn, isOpen);
  for (unsigned left = bitsOf(isOpen); left; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    drawn[lane] = drawnState(f, run.x + lane, run.y, key[lane]);
  }
  return drawn;
}

/// A pixel of the hidden layer whose neighbours are not all of its element: whether the element ends there,
/// not counting ends that the front layer makes. Of two elements that meet, the one of higher rank is
/// outlined.
inline bool isOutline(const PaintFrame& f, int x, int y, std::uint32_t element) {
  const float rank = f.styles[element - 1].rank;
  for (int i = 0; i < 4; ++i) {
    const int step = (i & 2) != 0 ? 1 : -1;
    const std::size_t at =
        static_cast<std::size_t>(clamped(y + ((i & 1) != 0 ? 0 : step), f.height)) * f.width +
        clamped(x + ((i & 1) != 0 ? step : 0), f.width);
    const std::uint32_t other = f.hiddenElement[at];
    const int key = f.key[at];
    const bool isSeen = key != 0 && (key & 3) == kVisible;
    if (isSeen && other != element && (other == 0 || f.styles[other - 1].rank < rank) &&
        f.element[at] != element)
      return true;
  }
  return false;
}

struct Styles {
  Colours colour;
  Floats opacity;
  Ints isSelected, edgesAlone;
};
ALIDADE_LENS_INLINE Styles stylesOf(const PaintFrame& f, const Ints& element, const Ints& wanted) {
  const Ints record = (element - 1) * static_cast<int>(sizeof(PaintStyle) / 8);
  const PaintStyle* s = f.styles;
  Styles styles;
  styles.colour = {gatheredFloats<8>(&s->colour[0], record, wanted),
                   gatheredFloats<8>(&s->colour[1], record, wanted),
                   gatheredFloats<8>(&s->colour[2], record, wanted)};
  styles.opacity = gatheredFloats<8>(&s->opacity, record, wanted);
  styles.isSelected = gathered<8>(&s->selected, record, wanted) != 0;
  styles.edgesAlone = gathered<8>(&s->edgesAlone, record, wanted) != 0;
  return styles;
}
ALIDADE_LENS_INLINE Colours selectionColour() {
  return {all(255.0f), all(255 * 0.55f), all(255 * 0.05f)};
}

ALIDADE_LENS_INLINE Colours overFace(const PaintFrame& f, const Run& run, const Colours& under,
                                     const Words& face, const Ints& isUnknown) {
  Colours c = designColour(f, unpacked(face));
  Floats opacity = toFloats(asInts(face >> 24)) * (1.0f / 255.0f);
  if (any(isUnknown)) {
    const Floats dotted = dots(f, run, 7.0f) ? all(0.55f) : all(0.14f);
    opacity = isUnknown ? opacity * dotted : opacity;
    const Floats gray = luminance(c);
    c = chosen(isUnknown, mix(c, {gray, gray, gray}, all(0.4f)), c);
  }
  return mix(under, c, opacity);
}

/// A face that the scan hides, over whatever is seen: so faint that the picture stays readable. `behind` are
/// the elements; where `isThrough`, seen through a visible face.
ALIDADE_LENS_INLINE Colours overHidden(const PaintFrame& f, const Run& run, const Colours& under,
                                       const Ints& behind, const Ints& isThrough) {
  const Ints wanted = behind != 0;
  const Styles s = stylesOf(f, behind, wanted);
  const Colours c = chosen(s.isSelected, selectionColour(), designColour(f, s.colour));
  Floats opacity = s.isSelected ? all(0.3f) : all(0.12f);
  if (f.hiddenStyle == kDash) {
    const Floats zero{};
    // Through a visible face the outline speaks; the hatch only tells which side of it is meant.
    const Floats through = hatch(f, run, 14.0f, 0.12f) ? all(1.2f) : zero;
    const Floats alone = hatch(f, run, 9.0f, 0.22f) ? all(3.0f) : zero;
    opacity = opacity * (isThrough ? through : alone);
  }
  Colours out = chosen(wanted, mix(under, c, opacity * s.opacity), under);
  if (!f.drawsEdges) return out;
  const Ints through = wanted & isThrough;
  if (!any(through)) return out;
  const Around a = loadAround(f, f.hiddenElement, run);
  Ints outline = through &
                 ((a.left != behind) | (a.right != behind) | (a.above != behind) | (a.below != behind)) &
                 (kIota < run.some);
  for (unsigned left = bitsOf(outline); left; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    if (!isOutline(f, run.x + lane, run.y, static_cast<std::uint32_t>(behind[lane]))) outline[lane] = 0;
  }
  if (!any(outline)) return out;
  Floats share = all(0.5f);
  if (f.hiddenStyle == kDash) share = chequer(f, run, 6.0f) ? all(0.8f) : all(0.0f);
  return chosen(outline, mix(out, c, share), out);
}

ALIDADE_LENS_INLINE Colours overFaces(const PaintFrame& f, const Run& run, const Colours& under) {
  const Ints key = loadBytes(f.key + run.at, run.some);
  const Ints isDesign = key != 0;
  if (!any(isDesign)) return under;
  const Ints drawn = drawnStates(f, run, key);
  const Ints hidden = isDesign & (drawn == kHidden), seen = isDesign & (drawn != kHidden);
  Colours out = under;
  if (any(seen)) {
    const Words face = loadSome<Words>(f.faceColour + run.at, run.some);
    out = chosen(seen, overFace(f, run, under, face, seen & (drawn == kUnknown)), under);
  }
  if (f.hiddenStyle == kHide) return out;
  Ints behind{};
  if (any(hidden)) behind = hidden & loadSome<Ints>(f.element + run.at, run.some);
  Ints isThrough{};
  if (f.hasHiddenLayer) {
    isThrough = isDesign & ((key & 3) == kVisible);
    const Ints second = loadSome<Ints>(f.hiddenElement + run.at, run.some);
    behind = isThrough ? second : behind;
  }
  return any(behind != 0) ? overHidden(f, run, out, behind, isThrough) : out;
}

ALIDADE_LENS_INLINE Colours overEdges(const PaintFrame& f, const Run& run, const Colours& under,
                                      const Words& cover, const Ints& owner, const float* depths,
                                      EdgePixel*& taken) {
  constexpr float share = 1.0f / 255.0f;
  const Ints c = asInts(cover);
  const Floats seenLine = toFloats(c & 255) * share, seenCasing = toFloats(c >> 8 & 255) * share;
  const Floats hiddenLine = toFloats(c >> 16 & 255) * share, hiddenCasing = toFloats(c >> 24 & 255) * share;
  const Ints isHidden = hiddenCasing > 0.0f, isSeen = seenCasing > 0.0f;
  const Ints wanted = isHidden | isSeen;
  if (!any(wanted)) return under;
  const Styles s = stylesOf(f, owner, wanted);
  Colours out = under;
  if (any(isHidden)) {
    const Colours white{all(255.0f), all(255.0f), all(255.0f)}, dark{all(25.5f), all(25.5f), all(25.5f)};
    const Colours line =
        chosen(s.isSelected, selectionColour(), designColour(f, mix(s.colour, white, all(0.3f))));
    out = chosen(isHidden, mix(mix(out, dark, hiddenCasing), line, hiddenLine), out);
  }
  if (any(isSeen)) {
    const Floats bright = s.isSelected ? all(255.0f) : all(255 * 0.93f);
    const Colours dimmed{0.42f * s.colour.r, 0.42f * s.colour.g, 0.42f * s.colour.b};
    const Colours line = chosen(s.isSelected, selectionColour(), designColour(f, dimmed));
    out = chosen(isSeen, mix(mix(out, {bright, bright, bright}, seenCasing), line, seenLine), out);
  }
  if (any(s.edgesAlone)) {
    const Ints takes =
        wanted & s.edgesAlone & (loadSome<Ints>(f.element + run.at, run.some) == 0) & (kIota < run.some);
    if (any(takes)) {
      const Floats depth = load<Floats>(depths);
      const Floats scan = f.scanDepth ? loadSome<Floats>(f.scanDepth + run.at, run.some) : depth;
      const Ints state = stateOf(f, depth, scan);
      for (unsigned left = bitsOf(takes); left; left &= left - 1) {
        const int lane = __builtin_ctz(left);
        *taken++ = {static_cast<std::uint32_t>(run.at) + static_cast<std::uint32_t>(lane),
                    static_cast<std::uint32_t>(owner[lane]), depth[lane],
                    static_cast<std::uint8_t>(state[lane])};
      }
    }
  }
  return out;
}

std::uint32_t compose(const PaintFrame& f, int left, int top, const EdgeTile& tile, EdgePixel* taken) {
  EdgePixel* const first = taken;
  const int right = left + kTileSize < f.width ? left + kTileSize : f.width;
  const int bottom = top + kTileSize < f.height ? top + kTileSize : f.height;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; x += kLanes) {
      Run run{x, y, right - x, static_cast<std::size_t>(y) * f.width + x, {}, {}};
      run.column = toFloats(kIota + x) + 0.5f;
      run.row = all(static_cast<float>(y) + 0.5f);
      Colours colour = cameraImage(f, run);
      if (f.drawsFaces) colour = overFaces(f, run, colour);
      if (tile.cover) {
        const int place = (y - top) * kTileSize + x - left;
        const Words cover = load<Words>(tile.cover + place);
        if (any(cover != 0u))
          colour =
              overEdges(f, run, colour, cover, load<Ints>(tile.element + place), tile.depth + place, taken);
      }
      if (f.points) {
        const Words point = loadSome<Words>(f.points + run.at, run.some);
        colour = chosen((point >> 24) > 0u, mix(colour, unpacked(point), all(0.5f)), colour);
      }
      storeSome(f.colour + run.at, packed(colour, all(255)), run.some);
    }
  return static_cast<std::uint32_t>(taken - first);
}

}  // namespace
}  // namespace alidade
