// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace alidade {

namespace {

/// Metres, where the source has neither a scale nor bounds; and the finest that is chosen where it has bounds.
constexpr double kDefaultScale = 0.0001, kFinestScale = 1e-9;
/// Degrees a unit of the scan angle of the formats 6-10.
constexpr double kAngleUnit = 0.006;
/// Characters of the name of extra bytes.
constexpr std::size_t kLongestName = 32;
constexpr std::array kNormals = {"NormalX", "NormalY", "NormalZ"};

template <class T>
void put(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof value);
}

const ExtraColumn* columnOf(const PointBatch& batch, const char* name) {
  for (const ExtraColumn& column : batch.extra)
    if (column.name == name) return &column;
  return nullptr;
}

bool isField(const ExtraColumn& column, const char* name, NumberType type, int components = 1) {
  return column.name == name && column.type == type && column.components == components;
}

/// Columns that have a place in the record itself: the first of their name.
bool hasField(const ExtraColumn& column, int ordinal, int format) {
  if (ordinal > 0) return false;
  if (isField(column, "scan_flags", NumberType::U8) || isField(column, "user_data", NumberType::U8)) return true;
  if (isField(column, "scan_angle_rank", NumberType::I8)) return true;
  if (isField(column, "scan_angle", NumberType::I16)) return format >= 6;
  if (isField(column, "nir", NumberType::U16)) return format == 8 || format == 10;
  if (isField(column, "wave_packet", NumberType::U8, 29)) return format == 4 || format == 5 || format >= 9;
  return false;
}

/// Names that a reader would take for the record's own fields.
bool isFieldName(const std::string& name) {
  constexpr std::array names = {"rgb", "intensity", "classification", "return_number", "return_count", "number_of_returns", "gps_time",
                                "point_source", "point_source_id", "scan_flags", "scan_angle", "scan_angle_rank", "user_data", "nir",
                                "wave_packet", "scanner", "row", "column"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Calls visit(column, ordinal) for every ExtraColumn of a batch, numbered among those of its name; stops at its first error.
template <class Visit>
Result<void> forEachExtra(const PointBatch& batch, const Visit& visit) {
  for (std::size_t i = 0; i < batch.extra.size(); ++i) {
    const ExtraColumn& column = batch.extra[i];
    if (column.components <= 0) continue;
    int ordinal = 0;
    for (std::size_t k = 0; k < i; ++k) ordinal += batch.extra[k].components > 0 && batch.extra[k].name == column.name;
    if (Result<void> done = visit(column, ordinal); !done) return done;
  }
  return {};
}

/// The finest power of ten that reaches twice as far as the bounds in 32 bits, an axis as the others.
double finestScale(const Bounds& bounds) {
  const glm::dvec3 size = bounds.size();
  const double most = std::max({size.x, size.y, size.z});
  if (bounds.empty() || !std::isfinite(most)) return kDefaultScale;
  constexpr double kReach = 2147483647.0;  // steps to either side of the middle
  int exponent = -9;
  while (exponent < 3 && most > kReach * std::pow(10.0, exponent)) ++exponent;
  return exponent == -9 ? kFinestScale : std::pow(10.0, exponent);
}

tl::unexpected<Error> doesNotFit(const std::string& what, std::size_t point, const std::string& path) {
  return fail(what, fmt::format("{}, point {} of a batch", path, point),
              "Write a format without this limit, or correct the source");
}

}  // namespace

void LasSchema::addOwn(const char* name, NumberType type) {
  addExtra({Origin::Own, name, 0, name, type, 1, 0, {}});
}

void LasSchema::addUser(const ExtraColumn& column, int ordinal, const ScanNotes& notes) {
  Extra extra{Origin::User, column.name, ordinal, column.name.substr(0, kLongestName), column.type, column.components, 0, {}};
  const auto taken = [&](const std::string& name) {
    return isFieldName(name) || std::any_of(m_extras.begin(), m_extras.end(), [&](const Extra& each) { return each.name == name; });
  };
  for (int i = std::max(2, ordinal + 1); taken(extra.name); ++i) {
    const std::string number = fmt::format("_{}", i);
    extra.name = column.name.substr(0, kLongestName - number.size()) + number;
  }
  if (extra.name != column.name)
    m_remarks.push_back(fmt::format("The column \"{}\" is called \"{}\": its name {}", column.name, extra.name,
                                    column.name.size() > kLongestName ? "is too long" : "is another column's"));
  for (const ColumnMeaning& meaning : notes.columns)
    if (ordinal == 0 && meaning.column == column.name) extra.meaning = meaning;
  addExtra(std::move(extra));
}

void LasSchema::addExtra(Extra extra) {
  extra.offset = static_cast<std::uint32_t>(m_recordLength);
  m_recordLength += extra.size();
  m_extras.push_back(std::move(extra));
}

const LasSchema::Extra* LasSchema::find(Origin origin, const std::string& column, int ordinal) const {
  for (const Extra& extra : m_extras)
    if (extra.origin == origin && extra.ordinal == ordinal && extra.column == column) return &extra;
  return nullptr;
}

Result<LasSchema> LasSchema::of(const PointBatch& batch, const ScanInfo& info, const ScanNotes& notes, bool tree,
                                const std::string& path) {
  LasSchema schema;
  const bool colour = !batch.rgb.empty(), time = !batch.gpsTime.empty();
  const bool infrared = columnOf(batch, "nir") != nullptr, wave = !tree && columnOf(batch, "wave_packet") != nullptr;
  const bool old = !tree && !infrared && columnOf(batch, "scan_angle_rank") && !columnOf(batch, "scan_angle");
  if (old)
    schema.m_format = wave ? (colour ? 5 : 4) : (colour ? 2 : 0) + (time ? 1 : 0);
  else
    schema.m_format = wave ? (colour || infrared ? 10 : 9) : infrared ? 8 : colour ? 7 : 6;
  schema.m_recordLength = lasRecordLength(schema.m_format);
  schema.m_scale = glm::all(glm::greaterThan(info.scale, glm::dvec3(0))) ? info.scale : glm::dvec3(finestScale(info.bounds));
  schema.m_offset = info.offset;
  if (schema.m_scale != info.scale)
    schema.m_offset = glm::round(!info.bounds.empty() ? info.bounds.centre() : batch.size() ? batch.position[0] : glm::dvec3(0));

  if (!batch.scanner.empty()) schema.addOwn("scanner", NumberType::U16);
  if (!batch.row.empty() && !batch.column.empty()) {
    schema.addOwn("row", NumberType::U32);
    schema.addOwn("column", NumberType::U32);
  }
  if (!batch.normal.empty())
    for (const char* name : kNormals) schema.addOwn(name, NumberType::F32);
  (void)forEachExtra(batch, [&](const ExtraColumn& column, int ordinal) -> Result<void> {
    if (!hasField(column, ordinal, schema.m_format)) schema.addUser(column, ordinal, notes);
    return {};
  });
  if (schema.m_recordLength > 4096)
    return fail(fmt::format("The columns take {} bytes a point, more than 4096", schema.m_recordLength), path,
                "Leave out extra columns");
  return schema;
}

std::vector<std::byte> LasSchema::extraBytesRecord() const {
  // Entries of 192 bytes (LAS 1.4 R15, table 24): type at 2, options at 3, name at 4, what the numbers mean from 40 on.
  // Types 1-10, and in the deprecated 11-30 two or three of them; anything else is told by its size alone.
  constexpr std::array<std::uint8_t, 10> codes = {2, 1, 4, 3, 6, 5, 8, 7, 9, 10};
  std::vector<std::byte> record;
  const auto add = [&](const std::string& name, int type, std::size_t options, const ColumnMeaning& meaning) {
    const std::size_t at = record.size();
    record.resize(at + 192);
    record[at + 2] = static_cast<std::byte>(type);
    record[at + 3] = static_cast<std::byte>(options);
    std::memcpy(record.data() + at + 4, name.data(), std::min(name.size(), kLongestName));
    std::memcpy(record.data() + at + 160, meaning.description.data(), std::min<std::size_t>(meaning.description.size(), 32));
    if (type == 0) return;
    const auto triple = [&](int bit, std::size_t field, const auto& values) {
      if ((meaning.given >> bit & 1) != 0) std::memcpy(record.data() + at + field, &values, 24);
    };
    triple(0, 40, meaning.noData), triple(1, 64, meaning.least), triple(2, 88, meaning.largest);
    triple(3, 112, meaning.scale), triple(4, 136, meaning.offset);
  };
  for (const Extra& extra : m_extras) {
    if (extra.components <= 3) {
      add(extra.name, codes[static_cast<std::size_t>(extra.type)] + 10 * (extra.components - 1), extra.meaning.given & 0x1Fu, extra.meaning);
      continue;
    }
    for (std::size_t left = extra.size(); left > 0;) {
      const std::size_t part = std::min<std::size_t>(left, 255);
      add(extra.name, 0, part, extra.meaning);
      left -= part;
    }
  }
  return record;
}

void LasSchema::Totals::add(const Totals& other) {
  if (other.count == 0) return;
  low = count == 0 ? other.low : glm::min(low, other.low);
  high = count == 0 ? other.high : glm::max(high, other.high);
  firstTime = count == 0 ? other.firstTime : std::min(firstTime, other.firstTime);
  lastTime = count == 0 ? other.lastTime : std::max(lastTime, other.lastTime);
  for (std::size_t i = 0; i < byReturn.size(); ++i) byReturn[i] += other.byReturn[i];
  rounding = std::max(rounding, other.rounding);
  count += other.count;
}

Result<void> LasSchema::checkColumns(const PointBatch& batch, const std::string& path) const {
  const auto missing = [&](const std::string& name) {
    return fail(fmt::format("The points from here on have {}, which the file's first points had not", name), path,
                "Write scans of different columns to files of their own");
  };
  const bool colours = m_format == 2 || m_format == 3 || m_format == 5 || m_format == 7 || m_format == 8 || m_format == 10;
  if (!batch.rgb.empty() && !colours) return missing("colours");
  if (!batch.gpsTime.empty() && (m_format == 0 || m_format == 2)) return missing("GPS times");
  if (!batch.scanner.empty() && !find(Origin::Own, "scanner")) return missing("stations");
  if (!batch.row.empty() && !batch.column.empty() && !find(Origin::Own, "row")) return missing("rows and columns");
  if (!batch.normal.empty() && !find(Origin::Own, "NormalX")) return missing("normals");
  return forEachExtra(batch, [&](const ExtraColumn& column, int ordinal) -> Result<void> {
    if (hasField(column, ordinal, m_format)) return {};
    const Extra* extra = find(Origin::User, column.name, ordinal);
    if (!extra || extra->type != column.type || extra->components != column.components)
      return missing(fmt::format("the column \"{}\"", column.name));
    return {};
  });
}

Result<void> LasSchema::encodePositions(const PointBatch& batch, const std::string& path, std::byte* at,
                                        Totals& totals) const {
  constexpr double kMost = 2147483647.0;
  for (std::size_t i = 0; i < batch.size(); ++i, at += m_recordLength) {
    const glm::dvec3 steps = glm::round((batch.position[i] - m_offset) / m_scale);
    if (!(glm::all(glm::greaterThanEqual(steps, glm::dvec3(-kMost - 1))) && glm::all(glm::lessThanEqual(steps, glm::dvec3(kMost)))))
      return fail(fmt::format("The coordinates {:.3f} {:.3f} {:.3f} are too far from the offset for steps of {} m",
                              batch.position[i].x, batch.position[i].y, batch.position[i].z, m_scale.x),
                  path, "Write with a larger scale, or to several files");
    const glm::ivec3 number(steps);
    const glm::dvec3 change = glm::abs(m_scale * steps + m_offset - batch.position[i]);
    // Doubles of the same decimal number differ by less, however it was put together.
    constexpr double kSame = 4 * std::numeric_limits<double>::epsilon();
    const glm::dvec3 same = kSame * (glm::abs(batch.position[i]) + glm::abs(m_offset));
    for (int axis = 0; axis < 3; ++axis)
      if (change[axis] > same[axis]) totals.rounding = std::max(totals.rounding, change[axis]);
    for (int axis = 0; axis < 3; ++axis) put(at + 4 * axis, static_cast<std::int32_t>(number[axis]));
    totals.low = i == 0 ? number : glm::min(totals.low, number);
    totals.high = i == 0 ? number : glm::max(totals.high, number);
  }
  return {};
}

Result<void> LasSchema::encodeFields(const PointBatch& batch, const std::string& path, std::byte* first,
                                     Totals& totals) const {
  const bool isWide = wide();
  const unsigned mostReturns = isWide ? 15 : 7;
  std::byte* at = first;
  for (std::size_t i = 0; i < batch.size(); ++i, at += m_recordLength) {
    const unsigned number = batch.returnNumber.empty() ? 1 : batch.returnNumber[i];
    const unsigned count = batch.returnCount.empty() ? std::max(number, 1u) : batch.returnCount[i];
    const unsigned kind = batch.classification.empty() ? 0 : batch.classification[i];
    if (number > mostReturns || count > mostReturns)
      return doesNotFit(fmt::format("Return {} of {} does not fit point format {}", number, count, m_format), i, path);
    if (!isWide && kind > 31)
      return doesNotFit(fmt::format("Classification {} does not fit point format {}", kind, m_format), i, path);
    if (number > 0) ++totals.byReturn[number - 1];
    if (!batch.intensity.empty()) put(at + 12, batch.intensity[i]);
    at[14] = static_cast<std::byte>(number | count << (isWide ? 4 : 3));
    at[isWide ? 16 : 15] = static_cast<std::byte>(kind);
    const std::uint16_t source = !batch.pointSource.empty() ? batch.pointSource[i]
                                 : !batch.scanner.empty()   ? static_cast<std::uint16_t>(batch.scanner[i] + 1)
                                                            : std::uint16_t{0};
    put(at + (isWide ? 20 : 18), source);
  }
  if (!batch.gpsTime.empty()) {
    const auto [low, high] = std::minmax_element(batch.gpsTime.begin(), batch.gpsTime.end());
    totals.firstTime = *low;
    totals.lastTime = *high;
    at = first + (isWide ? 22 : 20);
    for (std::size_t i = 0; i < batch.size(); ++i, at += m_recordLength) put(at, batch.gpsTime[i]);
  }
  if (!batch.rgb.empty()) {
    // The standard's colours are 16 bits; 8-bit ones are spread over them.
    const std::uint16_t factor = batch.rgbWhite > 255 ? 1 : 257;
    at = first + (isWide ? 30 : m_format == 2 ? 20 : 28);
    for (std::size_t i = 0; i < batch.size(); ++i, at += m_recordLength)
      for (int channel = 0; channel < 3; ++channel)
        put(at + 2 * channel, static_cast<std::uint16_t>(batch.rgb[i][channel] * factor));
  }
  return {};
}

Result<void> LasSchema::encodeExtraColumn(const ExtraColumn& column, int ordinal, std::size_t count, const std::string& path,
                                          std::byte* at) const {
  const auto each = [&](const auto& store) {
    for (std::size_t i = 0; i < count; ++i) store(at + i * m_recordLength, column.data.data() + i * column.bytesPerPoint());
  };
  if (!hasField(column, ordinal, m_format)) {
    const Extra* extra = find(Origin::User, column.name, ordinal);
    each([&](std::byte* record, const std::byte* value) { std::memcpy(record + extra->offset, value, extra->size()); });
  } else if (column.name == "scan_flags" && wide()) {
    each([](std::byte* record, const std::byte* value) { record[15] = *value; });
  } else if (column.name == "scan_flags") {
    for (std::size_t i = 0; i < count; ++i)
      if ((column.data[i] & std::byte{0x38}) != std::byte{0})
        return doesNotFit(fmt::format("An overlap flag or a scanner channel does not fit point format {}", m_format), i, path);
    each([](std::byte* record, const std::byte* value) {
      record[14] |= *value & std::byte{0xC0};
      record[15] |= *value << 5;
    });
  } else if (column.name == "user_data") {
    each([](std::byte* record, const std::byte* value) { record[17] = *value; });
  } else if (column.name == "scan_angle") {
    each([](std::byte* record, const std::byte* value) { std::memcpy(record + 18, value, 2); });
  } else if (column.name == "scan_angle_rank" && wide()) {
    each([](std::byte* record, const std::byte* value) {
      put(record + 18, static_cast<std::int16_t>(std::lround(lasValue<std::int8_t>(value, 0) / kAngleUnit)));
    });
  } else if (column.name == "scan_angle_rank") {
    each([](std::byte* record, const std::byte* value) { record[16] = *value; });
  } else if (column.name == "nir") {
    each([](std::byte* record, const std::byte* value) { std::memcpy(record + 36, value, 2); });
  } else if (column.name == "wave_packet") {
    const std::size_t field = lasRecordLength(m_format) - 29u;
    each([&](std::byte* record, const std::byte* value) { std::memcpy(record + field, value, 29); });
  }
  return {};
}

Result<void> LasSchema::encode(const PointBatch& batch, const std::string& path, std::vector<std::byte>& records,
                               Totals& totals) const {
  if (auto ok = checkColumns(batch, path); !ok) return ok;
  const std::size_t start = records.size(), count = batch.size();
  if (count == 0) return {};
  records.resize(start + count * m_recordLength);
  std::byte* at = records.data() + start;
  Totals more;
  more.count = count;
  if (auto ok = encodePositions(batch, path, at, more); !ok) return ok;
  if (auto ok = encodeFields(batch, path, at, more); !ok) return ok;
  const auto column = [&](const char* name, const auto& values) {
    const Extra* extra = find(Origin::Own, name);
    if (!extra || values.empty()) return;
    for (std::size_t i = 0; i < count; ++i) put(at + i * m_recordLength + extra->offset, values[i]);
  };
  column("scanner", batch.scanner);
  column("row", batch.row);
  column("column", batch.column);
  for (int axis = 0; axis < 3 && !batch.normal.empty(); ++axis) {
    const Extra* extra = find(Origin::Own, kNormals[static_cast<std::size_t>(axis)]);
    for (std::size_t i = 0; i < count; ++i) put(at + i * m_recordLength + extra->offset, batch.normal[i][axis]);
  }
  const auto encodeExtra = [&](const ExtraColumn& extra, int ordinal) { return encodeExtraColumn(extra, ordinal, count, path, at); };
  if (auto ok = forEachExtra(batch, encodeExtra); !ok) return ok;
  totals.add(more);
  return {};
}

}  // namespace alidade
