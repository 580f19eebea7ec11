// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/scanner.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "base/parallel.h"
#include "simulate/las_writer.h"
#include "simulate/materials.h"
#include "simulate/random.h"

namespace alidade {

namespace {

constexpr std::uint64_t kHeadingStream = 301, kShotStream = 302;

glm::dvec3 shotDirection(const ScannerModel& model, const ScanStation& station, std::uint32_t row,
                         std::uint32_t column) {
  const double span = model.highestElevation - model.lowestElevation;
  const double elevation = model.highestElevation - (row + 0.5) * span / station.rows;
  const double azimuth = 2.0 * std::numbers::pi * (column + 0.5) / station.columns;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

std::vector<ScanStation> placeStations(const SiteModel& site, const ScannerModel& model, std::uint32_t seed) {
  std::vector<ScanStation> stations;
  Random random(seed, kHeadingStream);
  for (const glm::dvec3& ground : site.stations) {
    ScanStation station;
    station.name = fmt::format("Station {}", stations.size() + 1);
    station.siteFromScanner.rotation =
        glm::angleAxis(random.uniform(0.0, 2.0 * std::numbers::pi), glm::dvec3(0, 0, 1));
    station.siteFromScanner.translation = ground + glm::dvec3(0, 0, model.heightMeters);
    station.worldFromScanner = site.worldFromSite * station.siteFromScanner;
    stations.push_back(station);
  }
  return stations;
}

/// Measures the shots of one station; thread-safe.
class Shooter {
 public:
  Shooter(const RayScene& scene, const Lighting& lighting, const ScannerModel& model, std::uint32_t seed,
          bool colour)
      : m_scene(scene), m_lighting(lighting), m_model(model), m_seed(seed), m_colour(colour) {}

  /// Appends the points of one column; returns how many are mixed pixels.
  std::uint32_t column(const ScanStation& station, int index, std::uint32_t column,
                       std::vector<LasPoint>& out) const {
    const glm::dvec3 origin = station.siteFromScanner.translation;
    const double step = (m_model.highestElevation - m_model.lowestElevation) / station.rows;
    const double straddles = std::min(0.35, m_model.beamRadians / step);
    std::uint32_t mixed = 0;
    double previous = std::numeric_limits<double>::infinity();
    for (std::uint32_t row = 0; row < station.rows; ++row) {
      const glm::dvec3 inScanner = shotDirection(m_model, station, row, column);
      const glm::dvec3 direction = station.siteFromScanner.rotation * inScanner;
      const RayHit hit = m_scene.intersect(origin, direction, m_model.rangeMeters);
      const double before = previous;
      previous = hit.distance;
      if (!hit) continue;
      Random random(mixBits(m_seed) ^ static_cast<std::uint64_t>(index), kShotStream,
                    (static_cast<std::uint64_t>(column) << 32) | row);
      const SiteObject& object = m_scene.objectOf(hit.triangle);
      const glm::dvec3 at = origin + hit.distance * direction;
      const auto footprint = static_cast<float>(0.003 + 0.5 * m_model.beamRadians * hit.distance);
      const float incidence = glm::dot(hit.faceNormal, -glm::vec3(direction));
      const float reflectance =
          laserReflectance(object.material, surfaceAlbedo(object, at, hit.faceNormal, footprint));
      const double strength = reflectance * (0.15 + 0.85 * incidence);
      // Glass and grazing dark surfaces swallow some shots.
      if (random.uniform() > std::min(1.0, 6.0 * strength + 0.25)) continue;
      const double sigma = m_model.rangeNoiseMeters * std::sqrt(0.6 + 0.1 / std::max(0.05, strength)) *
                           (1.0 + hit.distance / 120.0);
      double range = hit.distance + std::clamp(random.normal(), -4.0, 4.0) * sigma;
      const double gap = std::abs(before - hit.distance);
      bool isMixed = false;
      if (gap > 0.03 && gap < m_model.mixedLimitMeters && random.uniform() < straddles) {
        range = glm::mix(range, before, random.uniform(0.05, 0.95));
        isMixed = true;
        ++mixed;
      }
      LasPoint point;
      point.position = station.worldFromScanner * (range * inScanner);
      const double faded = std::clamp(strength * (1.0 + 0.03 * random.normal()), 0.0, 1.0);
      point.intensity = static_cast<std::uint16_t>(std::lround(65535.0 * faded));
      point.classification = isMixed ? 1 : object.classification;
      point.rgb = rgbOf(at, hit, -glm::vec3(direction), footprint);
      point.pointSource = static_cast<std::uint16_t>(index + 1);
      point.gpsTime = 4.0e8 + 600.0 * index +
                      300.0 * (column + static_cast<double>(row) / station.rows) / station.columns;
      point.row = row;
      point.column = column;
      out.push_back(point);
    }
    return mixed;
  }

 private:
  glm::u8vec3 rgbOf(const glm::dvec3& at, const RayHit& hit, const glm::vec3& toScanner,
                    float footprint) const {
    glm::vec3 shown = displayColour(m_lighting.shade(at, hit, toScanner, footprint));
    if (!m_colour) shown = glm::vec3(glm::dot(shown, glm::vec3(0.299f, 0.587f, 0.114f)));
    return glm::u8vec3(glm::clamp(255.0f * shown + 0.5f, 0.0f, 255.0f));
  }

  const RayScene& m_scene;
  const Lighting& m_lighting;
  const ScannerModel& m_model;
  std::uint32_t m_seed;
  bool m_colour;
};

/// The step at which about `points` shots come back, from a coarse scan of each station.
double chooseStep(std::vector<ScanStation>& stations, const Shooter& shooter, const ScannerModel& model,
                  std::uint64_t points) {
  double returned = 0;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    ScanStation& station = stations[i];
    station.rows = 120;
    station.columns = 286;
    std::vector<std::size_t> hits(station.columns, 0);
    parallelFor(station.columns, 8, [&](std::size_t first, std::size_t last, int) {
      std::vector<LasPoint> column;
      for (std::size_t c = first; c < last; ++c) {
        column.clear();
        shooter.column(station, static_cast<int>(i), static_cast<std::uint32_t>(c), column);
        hits[c] = column.size();
      }
    });
    const double shots = static_cast<double>(station.rows) * station.columns;
    returned += static_cast<double>(std::accumulate(hits.begin(), hits.end(), std::size_t{0})) / shots;
  }
  const double span = model.highestElevation - model.lowestElevation;
  return std::sqrt(returned * span * 2.0 * std::numbers::pi / static_cast<double>(points));
}

/// One station, a run of columns at a time.
Result<void> scanStation(ScanStation& station, int index, const Shooter& shooter, LasWriter& las,
                         const Progress& progress) {
  const std::uint32_t run = std::clamp<std::uint32_t>(400'000u / station.rows, 1, station.columns);
  std::vector<std::vector<LasPoint>> columns(run);
  std::vector<std::uint32_t> mixed(run);
  for (std::uint32_t first = 0; first < station.columns; first += run) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(static_cast<double>(first) / station.columns,
                    fmt::format("Scanning from {}", station.name));
    const std::uint32_t count = std::min(run, station.columns - first);
    parallelFor(count, 4, [&](std::size_t low, std::size_t high, int) {
      for (std::size_t i = low; i < high; ++i) {
        columns[i].clear();
        mixed[i] = shooter.column(station, index, first + static_cast<std::uint32_t>(i), columns[i]);
      }
    });
    for (std::uint32_t i = 0; i < count; ++i) {
      station.points += columns[i].size();
      station.mixedPixels += mixed[i];
      if (auto written = las.write(columns[i]); !written) return written;
    }
  }
  return {};
}

}  // namespace

Result<ScanSummary> writeScan(const std::string& path, const SiteModel& site, const RayScene& scene,
                              const Lighting& lighting, const ScannerModel& model, std::uint64_t points,
                              std::uint32_t seed, bool colour, const Progress& progress) {
  ScanSummary summary;
  summary.stations = placeStations(site, model, seed);
  const Shooter shooter(scene, lighting, model, seed, colour);
  summary.stepRadians = chooseStep(summary.stations, shooter, model, points);
  const double span = model.highestElevation - model.lowestElevation;
  for (ScanStation& station : summary.stations) {
    station.rows = static_cast<std::uint32_t>(std::max(2L, std::lround(span / summary.stepRadians)));
    station.columns =
        static_cast<std::uint32_t>(std::max(4L, std::lround(2.0 * std::numbers::pi / summary.stepRadians)));
  }
  std::vector<Station> placed;
  for (const ScanStation& s : summary.stations) placed.push_back({s.name, s.worldFromScanner, s.rows, s.columns});
  LasWriter las;
  const glm::dvec3 origin = site.worldFromSite.translation;
  if (auto opened = las.open(path, origin, coordinateSystemAt(origin), placed); !opened) return fail(opened.error());
  const double share = 1.0 / static_cast<double>(summary.stations.size());
  for (std::size_t i = 0; i < summary.stations.size(); ++i) {
    auto scanned =
        scanStation(summary.stations[i], static_cast<int>(i), shooter, las,
                    progress.part(share * static_cast<double>(i), share * static_cast<double>(i + 1)));
    if (!scanned) return fail(scanned.error());
  }
  if (auto finished = las.finish(); !finished) return fail(finished.error());
  summary.points = las.count();
  return summary;
}

}  // namespace alidade
