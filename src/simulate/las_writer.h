// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "survey/point_batch.h"
#include "simulate/output_file.h"

namespace alidade {

/// One point of a terrestrial scan as LAS point format 7 keeps it.
struct LasPoint {
  glm::dvec3 position{0.0};  ///< world metres
  std::uint16_t intensity = 0;
  std::uint8_t classification = 1;
  glm::u8vec3 rgb{0};
  std::uint16_t pointSource = 0;  ///< station, from 1
  double gpsTime = 0;             ///< adjusted standard GPS time, seconds
  std::uint32_t row = 0, column = 0;
};

/// Writes LAS 1.4 point format 7 (ASPRS LAS specification 1.4 R15) with extra bytes `row` and `column`
/// (uint32), point by point; the header is patched with counts and bounds at the end. Where the scanner stood is
/// written as Alidade's own record: plugins/las/las_stations.h has its layout. A station's point source ID is its place
/// in the list, from 1.
class LasWriter {
 public:
  static constexpr double kScale = 0.0001;  ///< metres

  /// `offset`: about the middle of the site. `wkt`: of the CRS; may be empty.
  Result<void> open(const std::string& path, const glm::dvec3& offset, const std::string& wkt,
                    const std::vector<Station>& stations);
  Result<void> write(const std::vector<LasPoint>& points);
  Result<void> finish();
  std::uint64_t count() const { return m_count; }

 private:
  OutputFile m_file;
  glm::dvec3 m_offset{0.0};
  glm::i64vec3 m_low{0}, m_high{0};
  std::uint64_t m_count = 0;
  std::vector<unsigned char> m_buffer;
};

/// WKT of CH1903+ / LV95 where the place lies in Switzerland's easting and northing, else empty.
std::string coordinateSystemAt(const glm::dvec3& world);

}  // namespace alidade
