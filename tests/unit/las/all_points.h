// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "las/las_reader.h"

namespace alidade::testing {

/// All batches of a read as one.
struct AllPoints {
  PointBatch all;
  std::vector<ImportWarning> warnings;
  std::string error;

  const ExtraColumn* extra(const std::string& name) const {
    for (const auto& column : all.extra)
      if (column.name == name) return &column;
    return nullptr;
  }
};

inline void appendBatch(PointBatch& all, const PointBatch& batch) {
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(all.position, batch.position);
  append(all.rgb, batch.rgb);
  all.rgbWhite = batch.rgbWhite;
  append(all.intensity, batch.intensity);
  append(all.classification, batch.classification);
  append(all.returnNumber, batch.returnNumber);
  append(all.returnCount, batch.returnCount);
  append(all.gpsTime, batch.gpsTime);
  append(all.normal, batch.normal);
  append(all.scanner, batch.scanner);
  append(all.pointSource, batch.pointSource);
  append(all.row, batch.row);
  append(all.column, batch.column);
  if (all.extra.empty()) {
    all.extra = batch.extra;
  } else {
    ASSERT_EQ(all.extra.size(), batch.extra.size());
    for (std::size_t i = 0; i < all.extra.size(); ++i) append(all.extra[i].data, batch.extra[i].data);
  }
}

inline AllPoints readEverything(const std::string& path) {
  AllPoints result;
  const auto outcome = LasReader().read(
      path,
      [&](PointBatch& batch) {
        appendBatch(result.all, batch);
        batch = PointBatch{};  // a sink may take the columns away
        return true;
      },
      Progress());
  if (outcome)
    result.warnings = *outcome;
  else
    result.error = outcome.error().text();
  return result;
}

/// Equal in every column, bit for bit.
inline void expectSamePoints(const PointBatch& a, const PointBatch& b, const std::string& what) {
  const auto same = [&](const auto& x, const auto& y, const char* column) {
    EXPECT_EQ(x.size(), y.size()) << what << ": " << column;
    EXPECT_TRUE(x == y) << what << ": " << column << " differs";
  };
  same(a.position, b.position, "position");
  same(a.rgb, b.rgb, "rgb");
  same(a.intensity, b.intensity, "intensity");
  same(a.classification, b.classification, "classification");
  same(a.returnNumber, b.returnNumber, "returnNumber");
  same(a.returnCount, b.returnCount, "returnCount");
  same(a.gpsTime, b.gpsTime, "gpsTime");
  same(a.scanner, b.scanner, "scanner");
  same(a.pointSource, b.pointSource, "pointSource");
  same(a.row, b.row, "row");
  same(a.column, b.column, "column");
  ASSERT_EQ(a.extra.size(), b.extra.size()) << what;
  for (std::size_t i = 0; i < a.extra.size(); ++i) {
    EXPECT_EQ(a.extra[i].name, b.extra[i].name) << what;
    EXPECT_EQ(a.extra[i].components, b.extra[i].components) << what;
    same(a.extra[i].data, b.extra[i].data, a.extra[i].name.c_str());
  }
}

}  // namespace alidade::testing
