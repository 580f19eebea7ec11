// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/display_options.h"

#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/number_list.h"
#include "geometry/angle.h"
#include "geometry/bearing.h"

namespace alidade::cli {

namespace {

const std::map<std::string, LevelThreshold> kThresholds = {
    {"node", LevelThreshold::ByDistance}, {"point", LevelThreshold::ByPoint}, {"uniform", LevelThreshold::Uniform}};
const std::map<std::string, DensityLaw> kLaws = {{"pixel", DensityLaw::PointsPerPixel}, {"area", DensityLaw::PointsPerSquareMetre}};
const std::map<std::string, HiddenStyle> kHidden = {
    {"hide", HiddenStyle::Hide}, {"ghost", HiddenStyle::Ghost}, {"dash", HiddenStyle::Dash}};
const std::map<std::string, bool DisplaySettings::*> kPasses = {{"image", &DisplaySettings::imagePass},
                                                                {"depth", &DisplaySettings::depthPass},
                                                                {"design", &DisplaySettings::designPass},
                                                                {"points", &DisplaySettings::pointPass}};
const std::map<std::string, bool DisplaySettings::*> kSwitches = {
    {"faces", &DisplaySettings::designFaces},       {"edges", &DisplaySettings::designEdges},
    {"stake-points", &DisplaySettings::stakePoints}, {"annotations", &DisplaySettings::annotations},
    {"labels", &DisplaySettings::labels},           {"grey-picture", &DisplaySettings::grayscaleImage},
    {"grey-design", &DisplaySettings::grayscaleDesign}, {"round-points", &DisplaySettings::roundPoints}};

std::string namesOf(const std::map<std::string, bool DisplaySettings::*>& known) {
  std::string names;
  for (const auto& [name, member] : known) names += (names.empty() ? "" : ",") + name;
  return names;
}

Result<void> setAll(const std::string& list, const std::map<std::string, bool DisplaySettings::*>& known, const char* option, bool on,
                    DisplaySettings& display) {
  for (const std::string& name : wordList(list)) {
    const auto found = known.find(name);
    if (found == known.end()) return fail(fmt::format("'{}' is none of them", name), option, fmt::format("Give some of {}", namesOf(known)));
    display.*found->second = on;
  }
  return {};
}

Result<void> applyPasses(const std::string& list, DisplaySettings& display) {
  for (const auto& [name, member] : kPasses) display.*member = false;
  return setAll(list, kPasses, "--passes", true, display);
}

Result<glm::dvec3> parseLight(const std::string& text) {
  const auto v = numberList(text, 2, 2, "--light", "Give AZIMUTH,ELEVATION of where the light comes from, in degrees");
  if (!v) return fail(v.error());
  if (std::abs((*v)[1]) > 90) return fail("The elevation is beyond 90 degrees", "--light", "Give -90 to 90");
  return -directionOf({radiansFromDegrees((*v)[0]), radiansFromDegrees((*v)[1])});
}

CLI::Validator knownNames(const std::map<std::string, bool DisplaySettings::*>& known) {
  return checkedBy([&known](const std::string& list) { DisplaySettings ignored; return setAll(list, known, "", true, ignored); }, "LIST");
}

}  // namespace

struct DisplayOptions::Given {
  std::string passes, hidden, densityBy, threshold, with, without, light;
  std::optional<double> density, pointsPerSquareMetre, pointSize, opacity, depthToleranceMm, residualScale;
};

DisplayOptions::DisplayOptions(CLI::App& command) : m_points(command), m_given(std::make_shared<Given>()) {
  Given& g = *m_given;
  command.add_option("--passes", g.passes, "Draw only these of " + namesOf(kPasses))->check(knownNames(kPasses));
  command.add_option("--hidden", g.hidden, "Parts that the scan hides")->check(CLI::IsMember({"hide", "ghost", "dash"}));
  command.add_option("--with", g.with, "Switch on some of " + namesOf(kSwitches))->check(knownNames(kSwitches));
  command.add_option("--without", g.without, "Switch off some of these")->check(knownNames(kSwitches));
  command.add_option("--opacity", g.opacity, "Of the design's visible faces, 0 to 1")->check(numberWithin(0.0, 1.0));
  command.add_option("--depth-tolerance", g.depthToleranceMm, "Scan and design closer than this count as one surface, millimetres")
      ->check(numberWithin(0.0, 1000.0));
  command.add_option("--light", g.light, "AZIMUTH,ELEVATION of where the light comes from, degrees")->check(checkedBy(parseLight, "LIGHT"));
  command.add_option("--residual-scale", g.residualScale, "Residuals are drawn so many times as long")->check(numberWithin(1.0, 1000.0));
  command.add_option("--density", g.density, "Point density, 0 to 1")->check(numberWithin(0.0, 1.0));
  auto* by = command.add_option("--density-by", g.densityBy, "What the density counts: points a pixel, or points of an area of the scan")
      ->check(CLI::IsMember({"pixel", "area"}));
  command.add_option("--points-per-square-metre", g.pointsPerSquareMetre,
                     "Full density by area: D / ln(distance + 1) points a square metre; sets --density-by area")
      ->check(numberWithin(1.0, 1e9))->excludes(by);
  command.add_option("--threshold", g.threshold, "What is thinned by one distance: a node, a point, or all alike")
      ->check(CLI::IsMember({"node", "point", "uniform"}));
  command.add_option("--point-size", g.pointSize, "Factor on the automatic point size")->check(numberWithin(0.1, 20.0));
}

Result<void> DisplayOptions::apply(DisplaySettings& display) const {
  const Given& g = *m_given;
  if (!g.passes.empty())
    if (auto done = applyPasses(g.passes, display); !done) return done;
  if (!g.with.empty())
    if (auto done = setAll(g.with, kSwitches, "--with", true, display); !done) return done;
  if (!g.without.empty())
    if (auto done = setAll(g.without, kSwitches, "--without", false, display); !done) return done;
  if (!g.hidden.empty()) display.hidden = kHidden.at(g.hidden);
  if (g.opacity) display.designOpacity = *g.opacity;
  if (g.depthToleranceMm) display.depthToleranceM = *g.depthToleranceMm / 1000;
  if (!g.light.empty()) {
    const auto travel = parseLight(g.light);
    if (!travel) return fail(travel.error());
    display.lightDirection = *travel;
  }
  if (g.residualScale) display.residualScale = *g.residualScale;
  if (g.density) display.density = *g.density;
  if (!g.densityBy.empty()) display.densityLaw = kLaws.at(g.densityBy);
  if (g.pointsPerSquareMetre) {
    display.densityLaw = DensityLaw::PointsPerSquareMetre;
    display.pointsPerSquareMetre = *g.pointsPerSquareMetre;
  }
  if (!g.threshold.empty()) display.levelThreshold = kThresholds.at(g.threshold);
  if (g.pointSize) display.pointSize = *g.pointSize;
  return m_points.apply(display.points);
}

}  // namespace alidade::cli
