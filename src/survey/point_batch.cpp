// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/point_batch.h"

#include <cstring>

namespace alidade {

PointBatch PointBatch::every(std::size_t first, std::size_t step) const {
  PointBatch some;
  const std::size_t count = first < size() ? (size() - first + step - 1) / step : 0;
  const auto pick = [&]<class T>(const std::vector<T>& from, std::vector<T>& to) {
    if (from.empty()) return;
    to.resize(count);
    for (std::size_t i = 0; i < count; ++i) to[i] = from[first + i * step];
  };
  pick(position, some.position);
  pick(rgb, some.rgb);
  some.rgbWhite = rgbWhite;
  pick(intensity, some.intensity);
  pick(classification, some.classification);
  pick(returnNumber, some.returnNumber);
  pick(returnCount, some.returnCount);
  pick(gpsTime, some.gpsTime);
  pick(normal, some.normal);
  pick(scanner, some.scanner);
  pick(pointSource, some.pointSource);
  pick(row, some.row);
  pick(column, some.column);
  for (const ExtraColumn& column : extra) {
    ExtraColumn& thinned = some.extra.emplace_back(ExtraColumn{column.name, column.type, column.components, {}});
    const std::size_t bytes = column.bytesPerPoint();
    thinned.data.resize(count * bytes);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(thinned.data.data() + i * bytes, column.data.data() + (first + i * step) * bytes, bytes);
  }
  return some;
}

}  // namespace alidade
