// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_painting.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "cloud/colour_ramp.h"
#include "survey/classification.h"

namespace alidade {

namespace {

constexpr glm::u8vec3 kMissing{150, 150, 150};

/// Hues a golden angle apart, so that any few scans differ.
glm::u8vec3 scanColour(int scan) {
  const double hue = std::fmod(0.08 + 0.381966 * scan, 1.0) * 6.0;
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + hue, 6.0);
    return static_cast<std::uint8_t>(std::lround(255 * (0.9 - 0.6 * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0))));
  };
  return {channel(5), channel(3), channel(1)};
}

const char* columnOf(ColourBy by) {
  switch (by) {
    case ColourBy::Intensity: return "intensity";
    case ColourBy::Classification: return "classification";
    case ColourBy::Return: return "return_number";
    case ColourBy::GpsTime: return "gps_time";
    case ColourBy::Normal: return "normal";
    default: return nullptr;
  }
}

template <class T>
T valueAt(const AttributeColumn& column, std::uint64_t index) {
  T value;
  std::memcpy(&value, column.data.data() + index * sizeof(T), sizeof(T));
  return value;
}

}  // namespace

PointColours::PointColours(const ScanPoints& scan, const PointStyle& style, const glm::dvec3& eye)
    : m_store(*scan.store), m_by(style.colourBy), m_eye(eye) {
  if (const char* name = columnOf(m_by)) {
    m_column = m_store.attribute(name);
    m_grey = m_column == nullptr;
  }
  double low = style.rangeLow, high = style.rangeHigh;
  if (style.automaticRange) {
    if (scan.summary)
      if (const auto found = scan.summary->values.find(m_by); found != scan.summary->values.end())
        low = found->second.p01, high = found->second.p99;
    if (m_by == ColourBy::Distance) {
      // From the eye to the far end of the cloud; a logarithm would hide what is far.
      const Bounds& bounds = m_store.bounds();
      low = glm::length(glm::clamp(eye, bounds.min, bounds.max) - eye);
      const glm::dvec3 far = glm::max(glm::abs(bounds.min - eye), glm::abs(bounds.max - eye));
      high = std::min(glm::length(far), low + 100.0);
    }
  }
  m_low = low;
  m_scale = high > low ? 256.0 / (high - low) : 0.0;
  m_table = rampTable(style.ramp);
  if (m_by == ColourBy::Classification)
    for (int code = 0; code < 256; ++code) m_table[code] = rgb565(classificationColour(static_cast<std::uint8_t>(code)));
  if (m_by == ColourBy::Scan) m_table.fill(rgb565(scanColour(scan.number)));
  if (m_grey) m_table.fill(rgb565(kMissing));
}

template <class ValueOf>
void PointColours::ramp(std::uint32_t count, std::uint16_t* rgb565, const ValueOf& valueOf) const {
  for (std::uint32_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(valueOf(i)) - m_low) * m_scale;
    // NaN fails the first comparison and takes the low end.
    rgb565[i] = m_table[at > 0 ? (at < 255 ? static_cast<int>(at) : 255) : 0];
  }
}

void PointColours::colours(const CloudNode& node, std::uint64_t first, std::uint32_t count,
                           std::uint16_t* rgb565) const {
  const DisplayPoint* points = m_store.points().data() + first;
  if (m_grey || m_by == ColourBy::Scan) {
    std::fill_n(rgb565, count, m_table[0]);
    return;
  }
  switch (m_by) {
    case ColourBy::Rgb:
    case ColourBy::Scan:
      for (std::uint32_t i = 0; i < count; ++i) rgb565[i] = points[i].rgb565;
      return;
    case ColourBy::Height:
      return ramp(count, rgb565, [&](std::uint32_t i) { return node.origin.z + node.step * points[i].z; });
    case ColourBy::Distance:
      return ramp(count, rgb565, [&](std::uint32_t i) {
        return glm::length(node.origin - m_eye + node.step * glm::dvec3(points[i].x, points[i].y, points[i].z));
      });
    case ColourBy::Classification:
      for (std::uint32_t i = 0; i < count; ++i) rgb565[i] = m_table[valueAt<std::uint8_t>(*m_column, first + i)];
      return;
    case ColourBy::Normal:
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto normal = valueAt<glm::vec3>(*m_column, first + i);
        rgb565[i] = alidade::rgb565(glm::u8vec3(glm::clamp(normal * 0.5f + 0.5f, 0.0f, 1.0f) * 255.0f));
      }
      return;
    case ColourBy::Intensity:
      return ramp(count, rgb565, [&](std::uint32_t i) { return valueAt<std::uint16_t>(*m_column, first + i); });
    case ColourBy::Return:
      return ramp(count, rgb565, [&](std::uint32_t i) { return valueAt<std::uint8_t>(*m_column, first + i); });
    case ColourBy::GpsTime:
      return ramp(count, rgb565, [&](std::uint32_t i) { return valueAt<double>(*m_column, first + i); });
  }
}

PointFilter::PointFilter(const PointStore& store, const PointStyle& style)
    : m_store(store), m_planes(style.clipPlanes()) {
  if (style.hiddenClasses.any()) m_classes = store.attribute("classification");
  for (std::size_t code = 0; code < m_classKept.size(); ++code) m_classKept[code] = !style.hiddenClasses[code];
}

PointFilter::Verdict PointFilter::of(const CloudNode& node) const {
  Verdict verdict = m_classes ? Verdict::Some : Verdict::All;
  for (const ClipPlane& plane : m_planes) {
    const double middle = glm::dot(plane.normal, node.bounds.centre()) - plane.offset;
    const double reach = glm::dot(glm::abs(plane.normal), 0.5 * node.bounds.size());
    if (middle + reach < 0) return Verdict::None;
    if (middle - reach < 0) verdict = Verdict::Some;
  }
  return verdict;
}

void PointFilter::keep(const CloudNode& node, std::uint64_t first, std::uint32_t count, std::uint8_t* keep) const {
  std::fill_n(keep, count, std::uint8_t{1});
  const DisplayPoint* points = m_store.points().data() + first;
  for (const ClipPlane& plane : m_planes) {
    // Only the sum over the node's own extent is left to floats.
    const auto start = static_cast<float>(glm::dot(plane.normal, node.origin) - plane.offset);
    const glm::vec3 slope(plane.normal * node.step);
    for (std::uint32_t i = 0; i < count; ++i)
      keep[i] &= start + slope.x * points[i].x + slope.y * points[i].y + slope.z * points[i].z >= 0.0f;
  }
  if (!m_classes) return;
  for (std::uint32_t i = 0; i < count; ++i) keep[i] &= m_classKept[valueAt<std::uint8_t>(*m_classes, first + i)];
}

}  // namespace alidade
