// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cloud/lattice.h"
#include "survey/number_type.h"
#include "survey/point_batch.h"
#include "survey/point_records.h"

namespace alidade {

/// One column of a store beside the points' places: what it is called and what it is made of.
struct ColumnShape {
  std::string name;  ///< "rgb", "intensity", … as PointSchema names them; an ExtraColumn's own name otherwise
  NumberType type = NumberType::U16;
  int components = 1;
  bool extra = false;  ///< an ExtraColumn of the source
  int ordinal = 0;     ///< among extra columns of one name and kind, from 0

  std::size_t bytes() const { return numberSize(type) * static_cast<std::size_t>(components); }
  friend bool operator==(const ColumnShape&, const ColumnShape&) = default;
};

/// True for a column that PointBatch has a place for, with the type it has there.
bool isOwnColumn(const ColumnShape& shape);

/// Of each of the format's fields.
std::vector<ColumnShape> shapesOf(const RecordFormat& format);

/// Which columns a store keeps: the union over the source's batches. A batch without a column that others
/// have counts as zeros there.
struct PointSchema {
  std::vector<ColumnShape> columns;
  std::uint16_t rgbWhite = 255;

  /// Adds what this batch, or what such records, bring. True where something was added.
  bool include(const PointBatch& batch);
  bool include(const RecordFormat& format);
  /// True where nothing would be added.
  bool covers(const PointBatch& batch) const;
  bool covers(const RecordFormat& format) const;
  std::size_t bytes() const;

  class Packing;
  /// Puts `count` values of column `index`, one after the other at `bytes`, where they belong in `batch`.
  void unpack(std::size_t index, const std::byte* bytes, std::size_t count, PointBatch& batch) const;

  friend bool operator==(const PointSchema&, const PointSchema&) = default;

 private:
  bool include(const std::vector<ColumnShape>& shapes, std::uint16_t white);
};

/// How the points of one batch, which the schema covers, become records.
class PointSchema::Packing {
 public:
  Packing(const PointSchema& schema, const PointBatch& batch);
  /// Writes the schema's columns of points first to first + count, one after the other and zeros up to the record's end:
  /// record i at out + i * stride, with `room` bytes.
  void pack(std::size_t first, std::size_t count, std::byte* out, std::size_t stride, std::size_t room) const;

 private:
  struct Column {
    const std::byte* data;
    std::size_t bytes;
    std::size_t at;  ///< in the record
    bool widened;    ///< 8-bit colours
    bool inWord() const { return bytes <= 8 && at / 8 == (at + bytes - 1) / 8; }
  };
  std::vector<Column> m_columns;  ///< that the batch has
};

/// 8-bit colours, of 3 numbers each and `stride` bytes apart, where white is 65535: 255 * 257 = 65535, and nothing is lost.
void widenColours(std::byte* first, std::size_t count, std::size_t stride);

/// RGB565 of colours of three 16-bit numbers each, `stride` bytes apart.
void rgb565Of(const std::byte* rgb, std::size_t stride, std::uint16_t rgbWhite, std::size_t count, std::uint16_t* rgb565);

/// The colours to draw `count` points with: RGB, else intensity as gray, else a middle gray. Columns that there are not
/// are empty. `brightestIntensity` is what white stands for.
void displayColours(std::span<const glm::u16vec3> rgb, std::uint16_t rgbWhite, std::span<const std::uint16_t> intensity,
                    std::uint16_t brightestIntensity, std::size_t count, std::uint16_t* rgb565);

}  // namespace alidade
