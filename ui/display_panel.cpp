// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/display_panel.h"

#include "geometry/angle.h"
#include "geometry/bearing.h"

namespace alidade {

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
  const auto turn = [&](const QString& name, const QString& tip, double low, double high, double Bearing::*member) {
    number(
        light, name, tip, tr("°"), low, high, 1, 0,
        [member](const auto& d) { return degreesFromRadians(bearingOf(-d.lightDirection).*member); },
        [member](auto& d, double v) {
          Bearing from = bearingOf(-d.lightDirection);
          from.*member = radiansFromDegrees(v);
          d.lightDirection = -directionOf(from);
        });
  };
  turn(tr("Azimuth"), tr("Where the light comes from, clockwise from north"), 0, 360, &Bearing::azimuthRad);
  turn(tr("Elevation"), tr("How high the light stands above the horizon"), -89, 89, &Bearing::elevationRad);

  QFormLayout* grey = section(tr("Colour"));
  check(grey, tr("Picture in grey (G)"), tr("So that the design stands out"),
        &DisplaySettings::grayscaleImage);
  check(grey, tr("Design in grey"), tr("For a grey picture of a grey camera"),
        &DisplaySettings::grayscaleDesign);

  finish();
}

}  // namespace alidade
