// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_summary.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace alidade {

namespace {

double valueAt(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

ValueHistogram histogramOf(std::vector<double>& values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  ValueHistogram histogram;
  if (values.empty()) return histogram;
  std::sort(values.begin(), values.end());
  histogram.p01 = valueAt(values, 0.01);
  histogram.p99 = valueAt(values, 0.99);
  const double low = valueAt(values, 0.005), high = valueAt(values, 0.995);
  const double margin = high > low ? 0.05 * (high - low) : std::max(1e-3, 1e-9 * std::abs(low));
  histogram.low = std::max(values.front(), low - margin);
  histogram.high = std::min(values.back(), high + margin);
  if (!(histogram.high > histogram.low)) histogram.high = histogram.low + margin;
  const double bins = static_cast<double>(histogram.counts.size()) / (histogram.high - histogram.low);
  for (const double v : values) {
    const double bin = std::clamp((v - histogram.low) * bins, 0.0, static_cast<double>(histogram.counts.size() - 1));
    ++histogram.counts[static_cast<std::size_t>(bin)];
  }
  return histogram;
}

ValueHistogram merged(const ValueHistogram& a, const ValueHistogram& b) {
  ValueHistogram both;
  both.low = std::min(a.low, b.low);
  both.high = std::max(a.high, b.high);
  both.p01 = std::min(a.p01, b.p01);
  both.p99 = std::max(a.p99, b.p99);
  const double bins = static_cast<double>(both.counts.size());
  for (const ValueHistogram* each : {&a, &b})
    for (std::size_t i = 0; i < each->counts.size(); ++i) {
      const double value = each->low + (static_cast<double>(i) + 0.5) / bins * (each->high - each->low);
      const double bin = (value - both.low) / (both.high - both.low) * bins;
      both.counts[static_cast<std::size_t>(std::clamp(bin, 0.0, bins - 1))] += each->counts[i];
    }
  return both;
}

}  // namespace

bool PointSummary::has(ColourBy by) const {
  switch (by) {
    case ColourBy::Rgb: return hasRgb;
    case ColourBy::Normal: return hasNormal;
    case ColourBy::Scan:
    case ColourBy::Distance: return true;
    case ColourBy::Classification: return std::any_of(classes.begin(), classes.end(), [](auto n) { return n > 0; });
    default: return values.contains(by);
  }
}

PointSummary summarise(const PointStore& store, std::size_t wanted) {
  PointSummary summary;
  if (store.pointCount() == 0) return summary;
  const double share = std::min(1.0, static_cast<double>(wanted) / static_cast<double>(store.pointCount()));
  const auto rgb = store.attribute("rgb"), normal = store.attribute("normal"),
             classification = store.attribute("classification");
  summary.hasRgb = rgb != nullptr;
  summary.hasNormal = normal != nullptr;
  const std::pair<ColourBy, const AttributeColumn*> ranged[] = {{ColourBy::Intensity, store.attribute("intensity")},
                                                                {ColourBy::Return, store.attribute("return_number")},
                                                                {ColourBy::GpsTime, store.attribute("gps_time")}};
  std::map<ColourBy, std::vector<double>> values;
  for (const CloudNode& node : store.nodes()) {
    // The node's first points are spread over all of it.
    const auto count = std::min<std::uint64_t>(node.count, static_cast<std::uint64_t>(std::ceil(share * node.count)));
    for (std::uint64_t i = node.first; i < node.first + count; ++i) {
      values[ColourBy::Height].push_back(node.origin.z + node.step * store.points()[i].z);
      for (const auto& [by, column] : ranged)
        if (column) values[by].push_back(column->at(i));
      if (classification) ++summary.classes[static_cast<std::uint8_t>(classification->at(i))];
    }
    summary.sampled += count;
  }
  for (auto& [by, all] : values) summary.values[by] = histogramOf(all);
  return summary;
}

PointSummary merged(const PointSummary& a, const PointSummary& b) {
  PointSummary both = a;
  both.sampled += b.sampled;
  both.hasRgb = a.hasRgb || b.hasRgb;
  both.hasNormal = a.hasNormal || b.hasNormal;
  for (std::size_t i = 0; i < both.classes.size(); ++i) both.classes[i] += b.classes[i];
  for (const auto& [by, histogram] : b.values) {
    const auto [at, isNew] = both.values.try_emplace(by, histogram);
    if (!isNew) at->second = merged(at->second, histogram);
  }
  return both;
}

}  // namespace alidade
