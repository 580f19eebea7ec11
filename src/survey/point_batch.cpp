// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/point_batch.h"

#include <cstring>

namespace alidade {

namespace {

/// The points that `indexOf(i)` names, for i below `count`.
template <class IndexOf>
PointBatch gathered(const PointBatch& from, std::size_t count, IndexOf&& indexOf) {
  PointBatch some;
  const auto pick = [&]<class T>(const std::vector<T>& column, std::vector<T>& to) {
    if (column.empty()) return;
    to.resize(count);
    for (std::size_t i = 0; i < count; ++i) to[i] = column[indexOf(i)];
  };
  pick(from.position, some.position);
  pick(from.rgb, some.rgb);
  some.rgbWhite = from.rgbWhite;
  pick(from.intensity, some.intensity);
  pick(from.classification, some.classification);
  pick(from.returnNumber, some.returnNumber);
  pick(from.returnCount, some.returnCount);
  pick(from.gpsTime, some.gpsTime);
  pick(from.normal, some.normal);
  pick(from.scanner, some.scanner);
  pick(from.pointSource, some.pointSource);
  pick(from.row, some.row);
  pick(from.column, some.column);
  for (const ExtraColumn& column : from.extra) {
    ExtraColumn& thinned = some.extra.emplace_back(ExtraColumn{column.name, column.type, column.components, {}});
    const std::size_t bytes = column.bytesPerPoint();
    thinned.data.resize(count * bytes);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(thinned.data.data() + i * bytes, column.data.data() + indexOf(i) * bytes, bytes);
  }
  return some;
}

}  // namespace

PointBatch PointBatch::every(std::size_t first, std::size_t step) const {
  const std::size_t count = first < size() ? (size() - first + step - 1) / step : 0;
  return gathered(*this, count, [&](std::size_t i) { return first + i * step; });
}

PointBatch PointBatch::chosen(std::span<const std::uint32_t> indices) const {
  return gathered(*this, indices.size(), [&](std::size_t i) { return std::size_t(indices[i]); });
}

}  // namespace alidade
