// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/display_panel.h"

#include <algorithm>
#include <cmath>

#include "geometry/angle.h"

namespace alidade {

LightAngles lightAngles(const glm::dvec3& travel) {
  const double length = glm::length(travel);
  if (!(length > 0)) return {0, 90};
  const glm::dvec3 from = -travel / length;
  double azimuth = degreesFromRadians(std::atan2(from.x, from.y));
  if (azimuth < 0) azimuth += 360;
  return {azimuth, degreesFromRadians(std::asin(std::clamp(from.z, -1.0, 1.0)))};
}

glm::dvec3 lightTravel(const LightAngles& angles) {
  const double a = radiansFromDegrees(angles.azimuth), e = radiansFromDegrees(angles.elevation);
  return -glm::dvec3(std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e));
}

DisplayPanel::DisplayPanel(Session& session, QWidget* parent) : SettingsForm(session, parent) {
  setObjectName(QStringLiteral("displayPanel"));

  QFormLayout* passes = section(tr("Passes"));
  check(passes, tr("Camera picture (1)"), tr("Draws the camera's picture"), &DisplaySettings::imagePass);
  check(passes, tr("Hiding by the scan (2)"), tr("Lets the scan hide the design"),
        &DisplaySettings::depthPass);
  check(passes, tr("Design (3)"), tr("Draws the design"), &DisplaySettings::designPass);
  check(passes, tr("Scan points (4)"), tr("Draws the scan in its own colour"), &DisplaySettings::pointPass);
  check(passes, tr("Stake-out points"), tr("Draws points to set out with their tolerance circles"),
        &DisplaySettings::stakePoints);
  check(passes, tr("Annotations"), tr("Draws texts, arrows and callouts"), &DisplaySettings::annotations);
  check(passes, tr("Labels"), tr("Writes names beside points"), &DisplaySettings::labels);

  QFormLayout* design = section(tr("Design"));
  choice(
      design, tr("Hidden parts"), tr("How parts that the scan hides are drawn (H)"),
      {tr("Hide"), tr("Ghost"), tr("Dashed")}, [](const auto& d) { return static_cast<double>(d.hidden); },
      [](auto& d, double v) { d.hidden = static_cast<HiddenStyle>(static_cast<int>(v)); });
  number(
      design, tr("Opacity"), tr("Of visible faces; edges stay solid"), tr(" %"), 0, 100, 1, 0,
      [](const auto& d) { return d.designOpacity * 100; },
      [](auto& d, double v) { d.designOpacity = v / 100; });
  check(design, tr("Faces"), tr("Fills the design's faces"), &DisplaySettings::designFaces);
  check(design, tr("Edges"), tr("Draws the design's borders and creases"), &DisplaySettings::designEdges);
  number(
      design, tr("Depth tolerance"), tr("Scan and design closer than this count as one surface"), tr(" mm"),
      0, 1000, 1, 0, [](const auto& d) { return d.depthToleranceM * 1000; },
      [](auto& d, double v) { d.depthToleranceM = v / 1000; });

  QFormLayout* light = section(tr("Light"));
  number(
      light, tr("Azimuth"), tr("Where the light comes from, clockwise from north"), tr("°"), 0, 360, 1, 0,
      [](const auto& d) { return lightAngles(d.lightDirection).azimuth; },
      [](auto& d, double v) {
        d.lightDirection = lightTravel({v, lightAngles(d.lightDirection).elevation});
      });
  number(
      light, tr("Elevation"), tr("How high the light stands above the horizon"), tr("°"), -89, 89, 1, 0,
      [](const auto& d) { return lightAngles(d.lightDirection).elevation; },
      [](auto& d, double v) {
        d.lightDirection = lightTravel({lightAngles(d.lightDirection).azimuth, v});
      });

  QFormLayout* grey = section(tr("Colour"));
  check(grey, tr("Picture in grey (G)"), tr("So that the design stands out"),
        &DisplaySettings::grayscaleImage);
  check(grey, tr("Design in grey"), tr("For a grey picture of a grey camera"),
        &DisplaySettings::grayscaleDesign);

  finish();
}

}  // namespace alidade
