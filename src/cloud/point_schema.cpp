// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/widest.h"

namespace alidade {

namespace {

/// Calls visit(name, type, components, column) for every column of its own that a batch has, filled or not.
template <class Batch, class Visit>
void forEachOwnColumn(Batch& batch, const Visit& visit) {
  visit("rgb", NumberType::U16, 3, batch.rgb);
  visit("intensity", NumberType::U16, 1, batch.intensity);
  visit("classification", NumberType::U8, 1, batch.classification);
  visit("return_number", NumberType::U8, 1, batch.returnNumber);
  visit("return_count", NumberType::U8, 1, batch.returnCount);
  visit("gps_time", NumberType::F64, 1, batch.gpsTime);
  visit("normal", NumberType::F32, 3, batch.normal);
  visit("scanner", NumberType::U16, 1, batch.scanner);
  visit("point_source", NumberType::U16, 1, batch.pointSource);
  visit("row", NumberType::U32, 1, batch.row);
  visit("column", NumberType::U32, 1, batch.column);
}

/// The batch's columns as bytes, each with its shape.
struct ColumnView {
  ColumnShape shape;
  const std::byte* data;
};

std::vector<ColumnView> viewsOf(const PointBatch& batch) {
  std::vector<ColumnView> views;
  forEachOwnColumn(batch, [&](const char* name, NumberType type, int components, const auto& column) {
    if (!column.empty() && column.size() == batch.size())
      views.push_back({{name, type, components, false}, reinterpret_cast<const std::byte*>(column.data())});
  });
  for (const ExtraColumn& extra : batch.extra) {
    if (extra.data.empty() || extra.data.size() != batch.size() * extra.bytesPerPoint()) continue;
    ColumnView view{{extra.name, extra.type, extra.components, true}, extra.data.data()};
    const auto same = [&](const ColumnView& other) { return other.shape == view.shape; };
    while (std::any_of(views.begin(), views.end(), same)) ++view.shape.ordinal;
    views.push_back(view);
  }
  return views;
}

template <std::size_t kBytes>
void scatter(const std::byte* from, std::size_t count, std::byte* to, std::size_t stride) {
  for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride, from + i * kBytes, kBytes);
}

void scatterBytes(const std::byte* from, std::size_t bytes, std::size_t count, std::byte* to, std::size_t stride) {
  switch (bytes) {
    case 1: scatter<1>(from, count, to, stride); break;
    case 2: scatter<2>(from, count, to, stride); break;
    case 4: scatter<4>(from, count, to, stride); break;
    case 6: scatter<6>(from, count, to, stride); break;
    case 8: scatter<8>(from, count, to, stride); break;
    case 12: scatter<12>(from, count, to, stride); break;
    default:
      for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride, from + i * bytes, bytes);
  }
}

constexpr std::size_t kWords = 128;

/// Puts a column's numbers of up to eight bytes into words, from bit `shift` on.
ALIDADE_WIDEST void addToWords(const std::byte* __restrict column, std::size_t bytes, std::size_t count, int shift,
                               std::uint64_t* __restrict words) {
  const auto add = [&](auto size) {
    for (std::size_t i = 0; i < count; ++i) {
      std::uint64_t number = 0;
      std::memcpy(&number, column + i * std::size_t{size}, size);
      words[i] |= number << shift;
    }
  };
  switch (bytes) {
    case 1:
      for (std::size_t i = 0; i < count; ++i) words[i] |= std::to_integer<std::uint64_t>(column[i]) << shift;
      return;
    case 2: return add(std::integral_constant<std::size_t, 2>{});
    case 4: return add(std::integral_constant<std::size_t, 4>{});
    case 6:
      // In two parts: a word put together in memory would have to wait for it.
      for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t low;
        std::uint16_t high;
        std::memcpy(&low, column + 6 * i, sizeof low);
        std::memcpy(&high, column + 6 * i + 4, sizeof high);
        words[i] |= (low | static_cast<std::uint64_t>(high) << 32) << shift;
      }
      return;
    case 8: return add(std::integral_constant<std::size_t, 8>{});
    default: return add(bytes);
  }
}

bool hasRgb(const RecordFormat& format) {
  return std::any_of(format.fields.begin(), format.fields.end(), [](const RecordField& f) { return !f.extra && f.name == "rgb"; });
}

std::uint16_t rgb565(unsigned r, unsigned g, unsigned b) {
  return static_cast<std::uint16_t>(((r >> 3) << 11) | ((g >> 2) << 5) | (b >> 3));
}

}  // namespace

bool isOwnColumn(const ColumnShape& shape) {
  bool found = false;
  const PointBatch none;
  forEachOwnColumn(none, [&](const char* name, NumberType type, int components, const auto&) {
    found = found || shape == ColumnShape{name, type, components, false, 0};
  });
  return found;
}

bool PointSchema::include(const PointBatch& batch) {
  std::vector<ColumnShape> shapes;
  for (const ColumnView& view : viewsOf(batch)) shapes.push_back(view.shape);
  return include(shapes, batch.rgb.empty() ? 0 : batch.rgbWhite);
}

bool PointSchema::include(const RecordFormat& format) {
  return include(shapesOf(format), hasRgb(format) ? format.rgbWhite : std::uint16_t{0});
}

bool PointSchema::include(const std::vector<ColumnShape>& shapes, std::uint16_t white) {
  bool added = white > rgbWhite;
  rgbWhite = std::max(rgbWhite, white);
  for (const ColumnShape& shape : shapes) {
    if (std::find(columns.begin(), columns.end(), shape) != columns.end()) continue;
    columns.push_back(shape);
    added = true;
  }
  return added;
}

bool PointSchema::covers(const PointBatch& batch) const {
  return !PointSchema(*this).include(batch);
}

bool PointSchema::covers(const RecordFormat& format) const {
  return !PointSchema(*this).include(format);
}

std::vector<ColumnShape> shapesOf(const RecordFormat& format) {
  std::vector<ColumnShape> shapes;
  for (const RecordField& field : format.fields) {
    ColumnShape shape{field.name, field.type, field.components, field.extra};
    while (std::find(shapes.begin(), shapes.end(), shape) != shapes.end()) ++shape.ordinal;
    shapes.push_back(shape);
  }
  return shapes;
}

void widenColours(std::byte* first, std::size_t count, std::size_t stride) {
  for (std::size_t i = 0; i < count; ++i) {
    std::array<std::uint16_t, 3> rgb;
    std::memcpy(rgb.data(), first + i * stride, sizeof rgb);
    for (std::uint16_t& channel : rgb) channel = static_cast<std::uint16_t>(channel * 257);
    std::memcpy(first + i * stride, rgb.data(), sizeof rgb);
  }
}

std::size_t PointSchema::bytes() const {
  std::size_t all = 0;
  for (const ColumnShape& column : columns) all += column.bytes();
  return all;
}

PointSchema::Packing::Packing(const PointSchema& schema, const PointBatch& batch) {
  const std::vector<ColumnView> views = viewsOf(batch);
  std::size_t at = 0;
  for (const ColumnShape& column : schema.columns) {
    const auto view = std::find_if(views.begin(), views.end(), [&](const ColumnView& v) { return v.shape == column; });
    const bool widened = !column.extra && column.name == "rgb" && batch.rgbWhite < schema.rgbWhite;
    if (view != views.end()) m_columns.push_back({view->data, column.bytes(), at, widened});
    at += column.bytes();
  }
}

void PointSchema::Packing::pack(std::size_t first, std::size_t count, std::byte* out, std::size_t stride, std::size_t room) const {
  // Word by word of all records: columns are brought together in registers, and a record is written once.
  std::array<std::uint64_t, kWords> words;
  for (std::size_t block = 0; block < count; block += kWords) {
    const std::size_t some = std::min(kWords, count - block);
    for (std::size_t word = 0; word < room; word += 8) {
      words.fill(0);
      for (const Column& column : m_columns)
        if (column.inWord() && column.at / 8 == word / 8)
          addToWords(column.data + (first + block) * column.bytes, column.bytes, some, static_cast<int>(column.at % 8 * 8), words.data());
      std::byte* to = out + block * stride + word;
      if (room - word >= 8)
        for (std::size_t i = 0; i < some; ++i) std::memcpy(to + i * stride, &words[i], 8);
      else
        for (std::size_t i = 0; i < some; ++i) std::memcpy(to + i * stride, &words[i], room - word);
    }
  }
  for (const Column& column : m_columns) {
    if (!column.inWord()) scatterBytes(column.data + first * column.bytes, column.bytes, count, out + column.at, stride);
    if (column.widened) widenColours(out + column.at, count, stride);
  }
}

void PointSchema::unpack(std::size_t index, const std::byte* bytes, std::size_t count, PointBatch& batch) const {
  const ColumnShape& shape = columns[index];
  if (shape.extra) {
    ExtraColumn& column = batch.extra.emplace_back(ExtraColumn{shape.name, shape.type, shape.components, {}});
    column.data.assign(bytes, bytes + count * shape.bytes());
    return;
  }
  if (shape.name == "rgb") batch.rgbWhite = rgbWhite;
  forEachOwnColumn(batch, [&](const char* name, NumberType, int, auto& column) {
    if (shape.name != name || count == 0) return;
    column.resize(count);
    std::memcpy(static_cast<void*>(column.data()), bytes, count * shape.bytes());
  });
}

void rgb565Of(const std::byte* rgb, std::size_t stride, std::uint16_t rgbWhite, std::size_t count, std::uint16_t* out) {
  const auto convert = [&](auto shift) {
    for (std::size_t i = 0; i < count; ++i) {
      std::array<std::uint16_t, 3> c;
      std::memcpy(c.data(), rgb + i * stride, sizeof c);
      out[i] = rgb565(c[0] >> shift & 255, c[1] >> shift & 255, c[2] >> shift & 255);
    }
  };
  if (rgbWhite > 255) convert(std::integral_constant<int, 8>());
  else convert(std::integral_constant<int, 0>());
}

void displayColours(std::span<const glm::u16vec3> rgb, std::uint16_t rgbWhite, std::span<const std::uint16_t> intensity,
                    std::uint16_t brightestIntensity, std::size_t count, std::uint16_t* out) {
  if (rgb.size() == count) {
    rgb565Of(std::as_bytes(rgb).data(), sizeof rgb[0], rgbWhite, count, out);
  } else if (intensity.size() == count && brightestIntensity > 0) {
    // Returns are few and bright at the top of the range: the root keeps the dark majority readable.
    const float white = 1.0f / brightestIntensity;
    for (std::size_t i = 0; i < count; ++i) {
      const auto gray = static_cast<unsigned>(255.0f * std::sqrt(std::min(1.0f, intensity[i] * white)) + 0.5f);
      out[i] = rgb565(gray, gray, gray);
    }
  } else {
    std::fill_n(out, count, rgb565(160, 160, 160));
  }
}

}  // namespace alidade
