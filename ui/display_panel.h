// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "ui/settings_form.h"

namespace alidade {

/// How the frame is drawn: passes, design, light. What concerns the scan's points has its own page.
class DisplayPanel : public SettingsForm {
  Q_OBJECT

 public:
  explicit DisplayPanel(Session& session, QWidget* parent = nullptr);
};

/// Direction the light comes from, degrees: azimuth clockwise from north, elevation above the horizon.
struct LightAngles {
  double azimuth = 0, elevation = 0;
};
LightAngles lightAngles(const glm::dvec3& travel);
glm::dvec3 lightTravel(const LightAngles& angles);

}  // namespace alidade
