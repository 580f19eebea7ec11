// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "cloud/point_store.h"
#include "survey/point_style.h"

namespace alidade {

/// How often each value of one attribute comes, from an even sample of a cloud's points. Values beyond
/// low and high count in the outer bins.
struct ValueHistogram {
  double low = 0, high = 0;  ///< of the bins: the 0.5th and 99.5th percentile and a little beyond
  double p01 = 0, p99 = 0;   ///< 1st and 99th percentile: the automatic range
  std::array<std::uint32_t, 128> counts{};
};

/// What a cloud's attributes hold, for ranges, legends and the list of classes.
struct PointSummary {
  std::uint64_t sampled = 0;
  /// By what has a range of numbers and stands in the cloud: Intensity, Height, Return, GpsTime.
  std::map<ColourBy, ValueHistogram> values;
  std::array<std::uint64_t, 256> classes{};  ///< sampled points of each class; all 0 without classes
  bool hasRgb = false, hasNormal = false;

  bool has(ColourBy by) const;
};

/// From at most `wanted` points, taken from all nodes alike.
PointSummary summarise(const PointStore& store, std::size_t wanted = 200000);

/// Both together: ranges that span both, counts added by bins.
PointSummary merged(const PointSummary& a, const PointSummary& b);

}  // namespace alidade
