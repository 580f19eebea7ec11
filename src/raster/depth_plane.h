// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>

namespace alidade {

/// Planes through dots in inverse depth, where a plane in space is linear on the screen (but for the
/// little that the lens bends a cell).

/// The tightness asked of a fit, as a part of the depth and in metres: the scan's own noise and a
/// gentle curve pass, a step of some four times as much does not.
inline constexpr float kResidual = 0.0025f;
inline constexpr float kResidualMeters = 0.010f;
/// Sums over the dots of a cell; x and y in pixels from the cell's middle, w the inverse depth.
struct Moments {
  float n = 0, x = 0, y = 0, w = 0, xx = 0, xy = 0, yy = 0, xw = 0, yw = 0, ww = 0;
  float level = 0;  ///< of the dots' own spacing, log2 px + 1

  void addDot(float px, float py, float pw, float plevel) {
    n += 1;
    x += px;
    y += py;
    w += pw;
    xx += px * px;
    xy += px * py;
    yy += py * py;
    xw += px * pw;
    yw += py * pw;
    ww += pw * pw;
    level += plevel;
  }

  /// Adds the dots of a cell whose middle lies at (dx, dy) from this one's.
  void add(const Moments& o, float dx, float dy) {
    n += o.n;
    x += o.x + dx * o.n;
    y += o.y + dy * o.n;
    w += o.w;
    xx += o.xx + dx * (2 * o.x + dx * o.n);
    xy += o.xy + dx * o.y + dy * o.x + dx * dy * o.n;
    yy += o.yy + dy * (2 * o.y + dy * o.n);
    xw += o.xw + dx * o.w;
    yw += o.yw + dy * o.w;
    ww += o.ww;
    level += o.level;
  }
};

/// w = w0 + gx x + gy y about a cell's middle.
struct Plane {
  float w0 = 0, gx = 0, gy = 0;
  float variance = 0;  ///< of the dots about it
  bool good = false;
};

template <class T>
T allowedResidual(T w) {
  return w * (kResidual + kResidualMeters * w);
}

inline Plane fit(const Moments& m) {
  Plane plane;
  if (m.n < 4) return plane;
  const double n = m.n, x = m.x / n, y = m.y / n, w = m.w / n;
  const double xx = m.xx - n * x * x, xy = m.xy - n * x * y, yy = m.yy - n * y * y;
  const double xw = m.xw - n * x * w, yw = m.yw - n * y * w, ww = m.ww - n * w * w;
  const double det = xx * yy - xy * xy;
  // Dots in a row carry no plane: the smaller axis must be a fair part of the larger one.
  const double trace = xx + yy;
  if (det < 0.02 * trace * trace) return plane;
  const double gx = (xw * yy - yw * xy) / det, gy = (yw * xx - xw * xy) / det;
  const double residual = std::max(0.0, ww - gx * xw - gy * yw) / std::max(1.0, n - 3);
  plane.variance = static_cast<float>(residual);
  const double allowed = allowedResidual(w);
  plane.good = residual <= allowed * allowed;
  plane.gx = static_cast<float>(gx);
  plane.gy = static_cast<float>(gy);
  plane.w0 = static_cast<float>(w - gx * x - gy * y);
  return plane;
}

}  // namespace alidade
